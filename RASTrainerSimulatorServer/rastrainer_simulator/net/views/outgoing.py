"""Messages to views about a state, a scene and a trace; docs/views.md explains them."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from rastrainer.number_text import with_units
from rastrainer.protocol import OPEN_PHASES, PROCEDURE_PHASES
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.loop.timing import Pacer
from rastrainer_simulator.presentation.messages import (
    CoveringBodies,
    GuideAim,
    Pose,
    ProcedureNews,
    SceneNews,
    ScreenNews,
    StateNews,
    TraceNews,
    message_text,
)
from rastrainer_simulator.presentation.presenter import TraceGuidance
from rastrainer_simulator.presentation.screen import Screen
from rastrainer_simulator.scene.nodes import TOOL, link_node_name, no_go_name
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.teleoperation.steering import AxesChoice
from rastrainer_simulator.training.head_pose import RegisteredPlan
from rastrainer_simulator.trial_state import Tool, TracedPoint
from rastrainer_simulator.vectors import Vector, in_meters, vector
from rastrainer_simulator.viewpoint.view_control import CameraPose, Pictures, aim, camera_pose

BODIES = (*map(link_node_name, range(8)), TOOL, "head", "stand", "plan")
GHOST_LINKS = (7,)
"""The links of the arm that are shown of a ghost, by the number of joints before each."""
GHOST_BODIES = (*(f"link_{joint}" for joint in GHOST_LINKS), "tool")
DECIMALS = 6
"""A micrometer in positions; in quaternions, less than that at the reach of the arm."""
NEWS_HZ = 5.0


def scene_news(sha256: str, scenario: Scenario, task: str, axes: AxesChoice) -> SceneNews:
    """Return the scene's address, cameras and fiducials; `axes` are the sticks' axes."""
    fiducials = {}
    if task:
        chosen = scenario.task(task)
        points = map(in_meters, chosen.fiducials)
        fiducials = dict(zip(chosen.labels, points, strict=True))
    return SceneNews(
        url=f"/scene/{sha256}.glb",
        task=task,
        sticks=axes,
        cameras={name: _rounded(camera_pose(camera)) for name, camera in scenario.cameras.items()},
        fiducials=fiducials,
        no_go={
            procedure.name: tuple(no_go_name(each.file) for each in procedure.no_go)
            for procedure in scenario.procedures
        },
    )


def state_news(
    now: SimulationState,
    delayed: int,
    pictures: Pictures,
    translucent: CoveringBodies,
    ghost: Sequence[np.ndarray] | None = None,
) -> StateNews:
    """Return poses, contact and progress.

    `delayed` ticks of the control loop were late or skipped; `ghost` are poses of `GHOST_BODIES`,
    (4, 4) float, to World, m.
    """
    training, planned = now.training, now.planned_target
    # Where the registration in use puts the MRI; else World's origin.
    procedure = now.training.procedure
    used = None if procedure is None else procedure.registration
    plan = None if used is None else RegisteredPlan.of(used.matrix)
    plan_to_world = np.eye(4)
    if plan is not None:
        plan_to_world[:3, :3] = np.transpose(plan.rows)
        plan_to_world[:3, 3] = plan.in_world((0.0, 0.0, 0.0))
    matrices = *now.body_poses, plan_to_world
    return StateNews(
        tick=now.tick,
        time_s=round(now.sim_time, DECIMALS),
        poses=tuple(_pose(matrix) for matrix in matrices),
        ghost=None if ghost is None else dict(zip(GHOST_BODIES, map(_pose, ghost), strict=True)),
        clearance_mm=round(now.clearance * MM_PER_M, 3),
        proximity=now.proximity,
        touch=now.touch,
        camera=now.camera,
        view=_rounded(pictures.main),
        inset=None if pictures.inset is None else _rounded(pictures.inset),
        translucent=translucent,
        phase=training.phase,
        next=training.next_point if training.is_marked else None,
        touched=tuple(touch.label for touch in training.touches) if training.is_marked else (),
        elapsed_s=round(now.completion_time, DECIMALS),
        planned_target=None if planned is None else planned.position,
        delayed=delayed,
        procedure=_procedure(now, pictures),
    )


def screen_text(screen: Screen) -> str:
    return with_units(message_text(ScreenNews(screen)))


def _procedure(now: SimulationState, pictures: Pictures) -> ProcedureNews | None:
    """Return what moves in a procedure's phases: by the registration in use, never the truth."""
    procedure, alignment, line = now.training.procedure, now.alignment, now.plan_in_world
    if procedure is None:
        return None
    seen = None
    if alignment is not None and line is not None and now.tool is Tool.GUIDE:
        entry, target = (
            (round(MM_PER_M * x, 2), round(MM_PER_M * y, 2))
            for x, y in aim(now.guide_axis, line, pictures)
        )
        seen = GuideAim(
            entry,
            target,
            round(MM_PER_M * alignment.entry_distance, 2),
            round(math.degrees(alignment.angle), 2),
        )
    return ProcedureNews(procedure.name, now.tool, round(MM_PER_M * now.feed, 3), seen)


def _rounded(pose: CameraPose) -> CameraPose:
    position, focal_point, view_up = (
        vector(round(value, DECIMALS) for value in each)
        for each in (pose.position, pose.focal_point, pose.view_up)
    )
    return CameraPose(position, focal_point, view_up, round(pose.view_angle_deg, DECIMALS))


def _pose(matrix: np.ndarray) -> Pose:
    rows = matrix.tolist()
    values = (rows[0][3], rows[1][3], rows[2][3], *quaternion(rows))
    x, y, z, qx, qy, qz, qw = (round(value, DECIMALS) for value in values)
    return x, y, z, qx, qy, qz, qw


def quaternion(rows: Sequence[Sequence[float]]) -> tuple[float, float, float, float]:
    """Return the unit quaternion (x, y, z, w) of a rotation matrix, given row by row.

    The largest of the four is found first and the others divided by it (Shepperd 1978), so that no
    angle loses digits. Only the rotation of a (4, 4) pose counts.
    """
    (xx, xy, xz, *_), (yx, yy, yz, *_), (zx, zy, zz, *_) = rows[:3]
    squares = (1 + xx - yy - zz, 1 - xx + yy - zz, 1 - xx - yy + zz, 1 + xx + yy + zz)
    largest = max(range(4), key=squares.__getitem__)
    twice = math.sqrt(squares[largest])
    x, y, z, w = {
        0: lambda: (twice, (xy + yx) / twice, (xz + zx) / twice, (zy - yz) / twice),
        1: lambda: ((xy + yx) / twice, twice, (yz + zy) / twice, (xz - zx) / twice),
        2: lambda: ((xz + zx) / twice, (yz + zy) / twice, twice, (yx - xy) / twice),
        3: lambda: ((zy - yz) / twice, (xz - zx) / twice, (yx - xy) / twice, twice),
    }[largest]()
    return x / 2, y / 2, z / 2, w / 2


class TraceUpdate:
    """The trace as all views know it; each message has only the new part."""

    def __init__(self) -> None:
        self._points: tuple[TracedPoint, ...] = ()
        self._places: tuple[Vector, ...] = ()
        self._guidance = TraceGuidance()
        self._pacer = Pacer(NEWS_HZ)

    def news(
        self, now: SimulationState, guidance: TraceGuidance, time_s: float
    ) -> TraceNews | None:
        """Return the new part; None if there is none, or it is too early to send it."""
        traced, phase = now.training.trace, now.training.phase
        is_shown = traced is not None and phase in OPEN_PHASES and phase not in PROCEDURE_PHASES
        points = traced.points if traced is not None and is_shown else ()
        wanted = guidance if is_shown else TraceGuidance()
        is_known = points is self._points or points == self._points
        if (is_known and wanted == self._guidance) or not self._pacer.is_due(time_s):
            return None
        pairs = enumerate(zip(self._points, points, strict=False))
        changed = (number for number, (old, new) in pairs if old is not new and old != new)
        known = next(changed, min(len(self._points), len(points)))
        new: tuple[Vector, ...] = ()
        if points[known:]:
            pose = now.head_to_world
            away = np.array([point.seen for point in points[known:]]) - pose[:3, 3]
            new = tuple(map(vector, np.round(MM_PER_M * away @ pose[:3, :3], 2).tolist()))
        self._points, self._guidance = points, wanted
        self._places = (*self._places[:known], *new)
        return TraceNews(known, new, wanted.covered_mm, wanted.next_place)

    def everything(self) -> TraceNews | None:
        """Return all that has been sent, for a view that has just joined; None for nothing."""
        if not self._places and self._guidance == TraceGuidance():
            return None
        guidance = self._guidance
        return TraceNews(0, self._places, guidance.covered_mm, guidance.next_place)
