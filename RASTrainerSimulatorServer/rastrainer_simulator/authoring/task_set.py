"""Propose a trial run and five tasks for any head."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, outward_normals
from rastrainer.scenario.points import LABELS, Task, task_file
from rastrainer.work_progress import Progress, no_progress
from rastrainer_simulator.authoring.face_removal import face_vertices
from rastrainer_simulator.authoring.planning_setup import WIDER, PlanningSetup
from rastrainer_simulator.authoring.task_proposal import (
    PLANS,
    CandidatePlaces,
    TaskProposer,
    places_seen_from,
)
from rastrainer_simulator.authoring.touch_order import shortest_path_mm
from rastrainer_simulator.scene.skin_marks import Skin, place_marks

ABOVE_BASE_MM = 25.0
SMOOTH_WITHIN_MM = 12.0
MAX_BENDING_DEG = 30.0
"""Most that a normal within that distance may differ: excludes ears, nostrils, eyelids, brows."""

DOWNWARD = -0.4
"""A point whose normal has a lower S than this cannot be seen or touched well."""


def smooth_places(mesh: HeadMesh, spacing_mm: float) -> np.ndarray:
    """Return the indices (n,) of vertices where the skin is smooth, `spacing_mm` apart."""
    height = mesh.vertices[:, 2] - mesh.vertices[:, 2].min()
    allowed = (height > ABOVE_BASE_MM) & (mesh.vertex_normals[:, 2] > DOWNWARD)
    allowed = np.flatnonzero(allowed)
    smooth, least = [], np.cos(np.radians(MAX_BENDING_DEG))
    for vertex in allowed[spread_out(mesh.vertices[allowed], spacing_mm)]:
        away = np.linalg.norm(mesh.vertices - mesh.vertices[vertex], axis=1)
        around = mesh.vertex_normals[away < SMOOTH_WITHIN_MM]
        if (around @ mesh.vertex_normals[vertex]).min() >= least:
            smooth.append(vertex)
    return np.array(smooth)


def spread_out(points: np.ndarray, spacing_mm: float) -> list[int]:
    """Return indices of points (n, 3) at least so far apart (farthest point sampling)."""
    chosen = [int(points[:, 2].argmax())]
    nearest = np.linalg.norm(points - points[chosen[0]], axis=1)
    while nearest.max() >= spacing_mm:
        chosen.append(int(nearest.argmax()))
        nearest = np.minimum(nearest, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return chosen


PLACE_SPACING_MM = 11.0
FACE_MARGIN_MM = 10.0
"""Least distance of fiducials from the face, so that it can be removed without moving any."""

WIDE_SEEDS, TRIAL_SEEDS = range(1000, 1006), range(2000, 2012)
"""Seeds of the poses in which a fiducial must be touchable: wider than in trials, and like them."""

ATTEMPTS = 6
WIDEN_DEG, WIDEST_DEG = 10.0, 75.0
"""If there is no room for the easy tasks, their angle to the view grows by this at each attempt."""

MAX_SHARE = 0.94
"""Largest share of the progress before the tasks are found."""

_DECIMALS = 4


class TaskSetProposer:
    """Proposes sets of tasks for one head and set-up; the same seed proposes the same set."""

    def __init__(self, planning: PlanningSetup, progress: Progress = no_progress) -> None:
        """Prepare proposals; `progress` may raise to cancel."""
        self._planning = planning
        self._progress = progress
        self._skin = Skin(planning.mesh)
        # In these, besides the nominal one, every fiducial must be touchable.
        self._poses = [*planning.poses(WIDE_SEEDS, WIDER)[1:], *planning.poses(TRIAL_SEEDS)[1:]]
        self._found: dict[tuple[float, ...], bool] = {}
        self._share = 0.0

    def propose(self, seed: int) -> tuple[Task, ...]:
        """Return the tasks, each more demanding than its predecessor.

        Their fiducials are on the skin, off the face, touchable in many poses of the head, and
        spread so that the target is located well; their numbers do not overlap.
        """
        planning, problem = self._planning, ""
        for attempt in range(ATTEMPTS):
            proposer = TaskProposer(
                planning.mesh,
                self._places,
                planning.eye,
                planning.scenario.target.position_ras,
                lambda one: place_marks(self._skin, one.fiducials, LABELS).has_room,
                self._are_touchable,
            )
            self._report("Placing fiducials", 0.3 + 0.1 * attempt)
            try:
                # Easy tasks have more room in each further attempt.
                wider = WIDEN_DEG * attempt
                plans = [
                    replace(plan, off_axis_deg=min(WIDEST_DEG, plan.off_axis_deg + wider))
                    for plan in PLANS
                ]
                proposals = proposer.propose_rising(plans, seed + attempt, attempt > 0)
            except InputError as error:
                problem = str(error)
                continue
            return tuple(
                Task(
                    one.plan.name,
                    one.plan.title,
                    task_file(one.plan.name),
                    round(one.complexity.index, 2),
                    round(shortest_path_mm(one.fiducials, planning.mesh, planning.graph), 1),
                    fiducials=one.fiducials,
                )
                for one in proposals
            )
        raise InputError(problem)

    @cached_property
    def _places(self) -> CandidatePlaces:
        planning = self._planning
        self._report("Finding smooth skin", 0.0)
        vertices = smooth_places(planning.mesh, PLACE_SPACING_MM)
        positions = planning.mesh.vertices[vertices].astype(float).round(_DECIMALS)
        normals = planning.mesh.vertex_normals[vertices]
        face = planning.mesh.vertices[face_vertices(planning.mesh)]
        if len(face):
            away = np.array([np.linalg.norm(face - place, axis=1).min() for place in positions])
            positions, normals = positions[away > FACE_MARGIN_MM], normals[away > FACE_MARGIN_MM]
        self._report("Finding what the robot can touch", 0.05)
        can_be = planning.touchable(positions, normals, planning.poses(range(0)))
        positions, normals = positions[can_be], normals[can_be]
        if len(positions) < len(LABELS):
            raise InputError(
                f"The robot can touch only {len(positions)} of {len(vertices)} places of this head "
                "where a fiducial could be; move the head closer to the robot."
            )
        self._report("Finding what the view shows", 0.2)
        return places_seen_from(planning.mesh, positions, normals, planning.eye)

    def _are_touchable(self, positions: np.ndarray) -> np.ndarray:
        """Return which points (n,) bool can be touched in every pose of a trial."""
        places = [tuple(position) for position in positions.tolist()]
        new = [place for place in places if place not in self._found]
        if new:
            self._report("Checking reach", 0.3 + 0.005 * len(self._found))
            normals = outward_normals(self._planning.mesh, np.array(new))
            can_be = self._planning.touchable(np.array(new), normals, self._poses)
            self._found |= dict(zip(new, can_be.tolist(), strict=True))
        return np.array([self._found[place] for place in places])

    def _report(self, step: str, share: float) -> None:
        self._share = max(self._share, min(share, MAX_SHARE))
        self._progress(step, self._share)
