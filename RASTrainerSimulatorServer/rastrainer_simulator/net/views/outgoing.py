"""The messages to views, as texts, and when they change; docs/views.md says what each means."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping, Sequence
from itertools import takewhile
from typing import Any

import numpy as np

from rastrainer.number_text import with_units
from rastrainer.protocol import OPEN_PHASES, PROCEDURE_PHASES
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.loop.timing import Pacer
from rastrainer_simulator.net.views.incoming import PROTOCOL, Worn
from rastrainer_simulator.presentation.presenter import Control, Feedback, TraceGuidance
from rastrainer_simulator.presentation.screen import Screen, screen_to_json
from rastrainer_simulator.scene.nodes import TOOL, link_node_name, no_go_name
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.teleoperation.steering import AxesChoice
from rastrainer_simulator.training.head_pose import RegisteredPlan
from rastrainer_simulator.trial_state import Tool, TracedPoint
from rastrainer_simulator.vectors import Vector, vector
from rastrainer_simulator.viewpoint.view_control import CameraPose, Pictures, aim, camera_pose

WELCOME = "welcome"
SCENE = "scene"
STATE = "state"
SCREEN = "screen"
EVENT = "event"
CONTROL = "control"
PAIRING = "pairing"
TRACE = "trace"
SEAT = "seat"

BODIES = (*map(link_node_name, range(8)), TOOL, "head", "stand", "plan")
GHOST_LINKS = (7,)
"""The links of the arm that are shown of a ghost, by the number of joints before each."""
GHOST_BODIES = (*(f"link_{joint}" for joint in GHOST_LINKS), "tool")
# A micrometer, and less than that at the reach of the arm.
DECIMALS = 6
NEWS_HZ = 5.0
NOBODY = "null"


def welcome(view: int) -> str:
    """Return the first message to a view."""
    return _text(WELCOME, protocol=PROTOCOL, view=view, bodies=BODIES)


def scene(sha256: str, scenario: Scenario, task: str, axes: AxesChoice) -> str:
    """Return where the scene is, and what goes with it; `axes` are those of the sticks."""
    cameras = {name: _camera(camera_pose(camera)) for name, camera in scenario.cameras.items()}
    fiducials = {}
    if task:
        chosen = scenario.task(task)
        points = (chosen.fiducials / MM_PER_M).tolist()
        fiducials = dict(zip(chosen.labels, points, strict=True))
    return _text(
        SCENE,
        url=f"/scene/{sha256}.glb",
        task=task,
        sticks=axes.value,
        cameras=cameras,
        fiducials=fiducials,
        noGo={
            procedure.name: [no_go_name(each.file) for each in procedure.no_go]
            for procedure in scenario.procedures
        },
    )


def state(
    now: SimulationState,
    delayed: int,
    pictures: Pictures,
    translucent: Mapping[str, Sequence[str]],
    ghost: Sequence[np.ndarray] | None = None,
) -> str:
    """Return what moves.

    Args:
        now: a state.
        delayed: how many of the control loop's ticks were late or skipped.
        pictures: from where it is seen.
        translucent: bodies that cover tip or point in each picture.
        ghost: poses of `GHOST_BODIES`, (4, 4) float, to World, m; None without a ghost.
    """
    training, planned = now.training, now.planned_target
    matrices = (
        *now.link_to_world,
        now.tool_tip_to_world,
        now.head_to_world,
        now.stand_to_world,
        _plan_to_world(now),
    )
    return _text(
        STATE,
        tick=now.tick,
        time=round(now.sim_time, DECIMALS),
        poses=[_pose(matrix) for matrix in matrices],
        ghost=None if ghost is None else dict(zip(GHOST_BODIES, map(_pose, ghost), strict=True)),
        clearanceMm=round(now.clearance * MM_PER_M, 3),
        proximity=now.proximity.value,
        touch=now.touch.value,
        camera=now.camera,
        view=_camera(pictures.main),
        inset=None if pictures.inset is None else _camera(pictures.inset),
        translucent=translucent,
        phase=training.phase.value,
        next=training.next_point if training.is_marked else None,
        touched=[touch.label for touch in training.touches] if training.is_marked else [],
        elapsed=round(now.completion_time, DECIMALS),
        plannedTarget=None if planned is None else planned.position,
        delayed=delayed,
        procedure=_procedure(now, pictures),
    )


def wearer(worn: Worn) -> str:
    """Return where a headset and its controllers are, as the member `wearer` of a state."""
    poses = {
        name: None if pose is None else [round(value, DECIMALS) for value in pose]
        for name, pose in dataclasses.asdict(worn).items()
    }
    return json.dumps(poses, allow_nan=False, separators=(",", ":"))


def mirrored(state_text: str, wearer_text: str) -> str:
    """Return the state as a spectator gets it, with the wearer of a headset; "null" for none."""
    return f'{state_text[:-1]},"wearer":{wearer_text}}}'


def screen(now: Screen) -> str:
    """Return what the trainee reads."""
    return with_units(_text(SCREEN, screen=screen_to_json(now)))


def event(feedback: Feedback) -> str:
    """Return a sound and a vibration."""
    return _text(
        EVENT,
        number=feedback.number,
        kind=feedback.kind,
        sound=feedback.sound,
        volume=feedback.volume,
        rumble=feedback.rumble,
        data=feedback.data,
    )


def trace(known: int, new: Sequence[Sequence[float]], guidance: TraceGuidance) -> str:
    """Return what is new of a trace: `new` points (head, mm) after the first `known` ones."""
    place = guidance.next_place
    shown = None if place is None else {"positionMm": place.position, "normal": place.normal}
    covered_mm = guidance.covered_mm
    return _text(TRACE, known=known, points=new, coveredMm=covered_mm, next=shown)


def seat(**members: Any) -> str:
    """Return what a teacher's board shows of a seat."""
    return with_units(_text(SEAT, **members))


def control(now: Control, view: int) -> str:
    """Return who drives the arm, as it is sent to one view."""
    return _text(CONTROL, holder=now.holder, isYou=now.view == view)


def pairing(code: str, addresses: Sequence[str]) -> str:
    """Return how another view is paired; for this computer's own views only."""
    return _text(PAIRING, code=code, addresses=addresses)


def _plan_to_world(now: SimulationState) -> np.ndarray:
    """Return where the registration in use puts the MRI, (4, 4) float, m; else World's origin."""
    procedure = now.training.procedure
    used = None if procedure is None else procedure.registration
    plan = None if used is None else RegisteredPlan.of(used.matrix)
    pose = np.eye(4)
    if plan is not None:
        pose[:3, :3] = np.transpose(plan.rows)
        pose[:3, 3] = plan.in_world((0.0, 0.0, 0.0))
    return pose


def _procedure(now: SimulationState, pictures: Pictures) -> dict[str, Any] | None:
    """Return what moves in a procedure's phases: by the registration in use, never the truth."""
    procedure, alignment, line = now.training.procedure, now.alignment, now.plan_in_world
    if procedure is None:
        return None
    seen = None
    if alignment is not None and line is not None and now.tool is Tool.GUIDE:
        beside = aim(now.guide_axis, line, pictures)
        seen = {
            "entryMm": _millimeters(beside.entry),
            "targetMm": _millimeters(beside.target),
            "entryDistanceMm": round(MM_PER_M * alignment.entry_distance, 2),
            "angleDeg": round(math.degrees(alignment.angle), 2),
        }
    return {
        "name": procedure.name,
        "tool": now.tool.value,
        "feedMm": round(MM_PER_M * now.feed, 3),
        "aim": seen,
    }


def _millimeters(values: Sequence[float]) -> list[float]:
    return [round(MM_PER_M * value, 2) for value in values]


def _camera(pose: CameraPose) -> dict[str, Any]:
    return {
        "position": [round(value, DECIMALS) for value in pose.position],
        "focalPoint": [round(value, DECIMALS) for value in pose.focal_point],
        "viewUp": [round(value, DECIMALS) for value in pose.view_up],
        "viewAngleDeg": round(pose.angle_deg, DECIMALS),
    }


def _pose(matrix: np.ndarray) -> list[float]:
    rows = matrix.tolist()
    place = (rows[0][3], rows[1][3], rows[2][3])
    return [round(value, DECIMALS) for value in (*place, *quaternion(rows))]


def _text(kind: str, /, **members: Any) -> str:
    message: Mapping[str, Any] = {"type": kind, **members}
    return json.dumps(message, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def quaternion(rows: Sequence[Sequence[float]]) -> tuple[float, float, float, float]:
    """Return the unit quaternion (x, y, z, w) of a rotation matrix, given row by row.

    The largest of the four is found first and the others divided by it (Shepperd 1978), so that
    no angle loses digits. A (4, 4) pose is taken for its rotation.
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
    """The trace as all views know it; each message has only what they do not know."""

    def __init__(self) -> None:
        self._points: tuple[TracedPoint, ...] = ()
        self._places: list[list[float]] = []
        self._guidance = TraceGuidance()
        self._pacer = Pacer(NEWS_HZ)

    def news(self, now: SimulationState, guidance: TraceGuidance, time_s: float) -> str | None:
        """Return what is new, as a message; None where nothing is, or it is too early to send it.

        Args:
            now: a state.
            guidance: in that state.
            time_s: by which the messages are paced.
        """
        traced, phase = now.training.trace, now.training.phase
        is_shown = traced is not None and phase in OPEN_PHASES and phase not in PROCEDURE_PHASES
        points = traced.points if traced is not None and is_shown else ()
        wanted = guidance if is_shown else TraceGuidance()
        is_known = points is self._points or points == self._points
        if (is_known and wanted == self._guidance) or not self._pacer.is_due(time_s):
            return None
        known = sum(1 for _ in takewhile(_is_same, zip(self._points, points, strict=False)))
        new = _in_head([point.seen for point in points[known:]], now.head_to_world)
        self._points, self._guidance = points, wanted
        self._places = [*self._places[:known], *new]
        return trace(known, new, wanted)

    def everything(self) -> str | None:
        """Return all that has been sent, for a view that has just joined; None for nothing."""
        if not self._places and self._guidance == TraceGuidance():
            return None
        return trace(0, self._places, self._guidance)


def _is_same(pair: tuple[TracedPoint, TracedPoint]) -> bool:
    return pair[0] is pair[1] or pair[0] == pair[1]


def _in_head(places: Sequence[Sequence[float]], head_to_world: np.ndarray) -> list[list[float]]:
    """Return places (World, m) in the head's frame, mm."""
    if not places:
        return []
    away = np.array(places) - head_to_world[:3, 3]
    found: list[list[float]] = np.round(MM_PER_M * away @ head_to_world[:3, :3], 2).tolist()
    return found


class Mirror:
    """Keeps what the newest headset has sent; one that reconnects is another view."""

    def __init__(self) -> None:
        self._headsets: set[int] = set()
        self.text = NOBODY
        """JSON of what the newest headset sent last; "null" without one that is worn."""
        self.eyes: Vector | None = None
        """Where its wearer's eyes are, World, m; None without one."""

    def joined(self, view: int) -> None:
        """Follow a headset from now on."""
        self._headsets.add(view)
        self._show(None)

    def left(self, view: int) -> None:
        """Forget a view; the previous one, if any, is followed again."""
        if view in self._headsets and view == max(self._headsets):
            self._show(None)
        self._headsets.discard(view)

    def take(self, view: int, worn: Worn) -> None:
        """Process what a headset sends; only the newest is followed."""
        if view == max(self._headsets, default=None):
            self._show(worn)

    def _show(self, worn: Worn | None) -> None:
        eyes = None if worn is None else worn.eyes
        self.eyes = None if eyes is None else vector(eyes[:3])
        self.text = NOBODY if worn is None or eyes is None else wearer(worn)
