"""A trial run and five tasks for a head that nobody has seen before."""

from __future__ import annotations

from dataclasses import replace
from functools import cached_property

import numpy as np

from rastrainer.errors import InputError
from rastrainer.face_removal import face_vertices
from rastrainer.motion.shortest_path import shortest_path_mm
from rastrainer.progress import Progress
from rastrainer.surface_queries import outward_normals
from rastrainer.tasks import LABELS, Task
from rastrainer_simulator.planning.skin_places import smooth_places
from rastrainer_simulator.planning.task_proposal import (
    PLANS,
    Places,
    Proposal,
    TaskPlan,
    TaskProposer,
    places_seen_from,
)
from rastrainer_simulator.planning.workbench import WIDER, Workbench
from rastrainer_simulator.scene.skin import Skin
from rastrainer_simulator.scene.skin_marks import place_marks

PLACE_SPACING_MM = 11.0
FACE_MARGIN_MM = 10.0
"""No fiducial comes nearer to the face, so that it can be taken off without moving any."""

WIDE_SEEDS, TRIAL_SEEDS = range(1000, 1006), range(2000, 2012)
"""Of the poses in which a fiducial must be touchable: worse than a trial's, and like a trial's."""

ATTEMPTS = 6
WIDEN_DEG, WIDEST_DEG = 10.0, 75.0
"""Where there is no room for the easy tasks, they may lie so much farther from the middle of the
view, each time."""

MOST_SHARE = 0.94
"""Of the progress, before the tasks are found."""

_DECIMALS = 4


class TaskSetProposer:
    """Proposes sets of tasks for one head and set-up; the same seed proposes the same set."""

    def __init__(self, bench: Workbench, progress: Progress = lambda _step, _share: None) -> None:
        """Keep the head; `progress` is told what is done and may raise to cancel."""
        self._bench = bench
        self._progress = progress
        self._skin = Skin(bench.mesh)
        self._found: dict[tuple[float, ...], bool] = {}
        self._share = 0.0

    def propose(self, seed: int) -> tuple[Task, ...]:
        """Return the tasks, each more demanding than the one before.

        Their fiducials are on the skin, off the face, touchable in many poses of the head, and
        spread so that the target is located well; their numbers do not overlap.

        Raises:
            InputError: the robot reaches too little of this head, or there is no room.
        """
        bench, problem = self._bench, ""
        for attempt in range(ATTEMPTS):
            proposer = TaskProposer(
                bench.mesh,
                self._places,
                bench.eye,
                bench.scenario.target_position,
                self._is_readable,
                self._are_touchable,
            )
            self._tell("Placing fiducials", 0.3 + 0.1 * attempt)
            try:
                proposals = proposer.propose_rising(
                    _plans(attempt), seed + attempt, begins_easy=attempt > 0
                )
            except InputError as error:
                problem = str(error)
                continue
            return tuple(_task(proposal, bench) for proposal in proposals)
        raise InputError(problem)

    @cached_property
    def _places(self) -> Places:
        """Where fiducials may be."""
        bench = self._bench
        self._tell("Finding smooth skin", 0.0)
        vertices = smooth_places(bench.mesh, PLACE_SPACING_MM)
        positions = bench.mesh.vertices[vertices].astype(float).round(_DECIMALS)
        normals = bench.mesh.vertex_normals[vertices]
        face = bench.mesh.vertices[face_vertices(bench.mesh)]
        if len(face):
            away = np.array([np.linalg.norm(face - place, axis=1).min() for place in positions])
            positions, normals = positions[away > FACE_MARGIN_MM], normals[away > FACE_MARGIN_MM]
        self._tell("Finding what the robot can touch", 0.05)
        can_be = bench.touchable(positions, normals, bench.poses(range(0)))
        positions, normals = positions[can_be], normals[can_be]
        if len(positions) < len(LABELS):
            raise InputError(
                f"The robot can touch only {len(positions)} of {len(vertices)} places of this head "
                "where a fiducial could be; bring the head nearer to the robot."
            )
        self._tell("Finding what the view shows", 0.2)
        return places_seen_from(bench.mesh, positions, normals, bench.eye)

    @cached_property
    def _poses(self) -> list[np.ndarray]:
        """In which every fiducial must be touchable, besides the nominal one."""
        bench = self._bench
        return [*bench.poses(WIDE_SEEDS, WIDER)[1:], *bench.poses(TRIAL_SEEDS)[1:]]

    def _are_touchable(self, positions: np.ndarray) -> np.ndarray:
        """Return which places (n,) bool can be touched wherever the head of a trial may stand."""
        places = [tuple(position) for position in positions.tolist()]
        new = [place for place in places if place not in self._found]
        if new:
            self._tell("Checking reach", 0.3 + 0.005 * len(self._found))
            normals = outward_normals(self._bench.mesh, np.array(new))
            can_be = self._bench.touchable(np.array(new), normals, self._poses)
            self._found |= dict(zip(new, can_be.tolist(), strict=True))
        return np.array([self._found[place] for place in places])

    def _tell(self, step: str, share: float) -> None:
        """Tell the progress, which never goes back."""
        self._share = max(self._share, min(share, MOST_SHARE))
        self._progress(step, self._share)

    def _is_readable(self, proposal: Proposal) -> bool:
        return place_marks(self._skin, proposal.fiducials, LABELS).has_room


def _plans(attempt: int) -> list[TaskPlan]:
    """Return the plans, the easy ones with more room after failures."""
    wider = WIDEN_DEG * attempt
    return [
        replace(plan, off_axis_deg=min(WIDEST_DEG, plan.off_axis_deg + wider)) for plan in PLANS
    ]


def _task(proposal: Proposal, bench: Workbench) -> Task:
    plan, fiducials = proposal.plan, proposal.fiducials
    return Task(
        plan.name,
        plan.title,
        LABELS,
        fiducials,
        round(proposal.complexity.index, 2),
        round(shortest_path_mm(fiducials, bench.mesh, bench.graph), 1),
    )
