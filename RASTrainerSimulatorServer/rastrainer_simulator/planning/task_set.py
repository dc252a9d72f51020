"""A trial run and five tasks for a head that nobody has seen before."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import cached_property

import numpy as np

from rastrainer.errors import InputError
from rastrainer.face_removal import face_vertices
from rastrainer.surface_queries import outward_normal
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

SCREENING_SEEDS = range(1000, 1006)
CHECK_SEEDS = range(2000, 2012)
ATTEMPTS = 4
WIDEN_DEG, WIDEST_DEG = 10.0, 75.0
"""Where there is no room for the easy tasks, they may lie so much farther from the middle of the
view, each time."""

NOT_ALL_TOUCHABLE = (
    "No set of tasks was found whose fiducials the robot can all touch; bring the head nearer to "
    "the robot, or let it stand with less perturbation."
)
_DECIMALS = 4

Progress = Callable[[str, float], None]


class TaskSetProposer:
    """Proposes sets of tasks for one head and set-up; the same seed proposes the same set."""

    def __init__(self, bench: Workbench, progress: Progress = lambda _step, _share: None) -> None:
        """Keep the head; `progress` is told what is done and may raise to cancel."""
        self._bench = bench
        self._progress = progress
        self._skin = Skin(bench.mesh)

    def propose(self, seed: int) -> tuple[Task, ...]:
        """Return the tasks, each more demanding than the one before.

        Their fiducials are on the skin, off the face, touchable in many poses of the head, and
        spread so that the target is located well; their numbers do not overlap.

        Raises:
            InputError: the robot reaches too little of this head, or there is no room.
        """
        places, problem = self._places, NOT_ALL_TOUCHABLE
        for attempt in range(ATTEMPTS):
            self._progress("Placing fiducials", 0.45 + 0.12 * attempt)
            try:
                proposer = self._proposer(places)
                proposals = proposer.propose_rising(
                    _plans(attempt), seed + attempt, begins_easy=attempt > 0
                )
            except InputError as error:
                problem = str(error)
                continue
            self._progress("Checking reach", 0.52 + 0.12 * attempt)
            missed = self._missed(proposals)
            if not len(missed):
                return tuple(_task(proposal) for proposal in proposals)
            is_kept = ~(places.positions[:, None] == missed[None]).all(axis=2).any(axis=1)
            places = Places(*(values[is_kept] for values in vars(places).values()))
        raise InputError(problem)

    @cached_property
    def _places(self) -> Places:
        """Where fiducials may be."""
        bench = self._bench
        self._progress("Finding smooth skin", 0.0)
        vertices = smooth_places(bench.mesh, PLACE_SPACING_MM)
        positions = bench.mesh.vertices[vertices].astype(float).round(_DECIMALS)
        normals = bench.mesh.vertex_normals[vertices]
        face = bench.mesh.vertices[face_vertices(bench.mesh)]
        if len(face):
            away = np.array([np.linalg.norm(face - place, axis=1).min() for place in positions])
            positions, normals = positions[away > FACE_MARGIN_MM], normals[away > FACE_MARGIN_MM]
        can_be = bench.touchable(positions, normals, self._screening_poses())
        positions, normals = positions[can_be], normals[can_be]
        if len(positions) < len(LABELS):
            raise InputError(
                f"The robot can touch only {len(positions)} of {len(vertices)} places of this head "
                "where a fiducial could be; bring the head nearer to the robot."
            )
        self._progress("Finding what the view shows", 0.38)
        return places_seen_from(bench.mesh, positions, normals, bench.eye)

    def _screening_poses(self) -> Iterator[np.ndarray]:
        """Yield poses of the head that are worse than a trial's, and tell the progress."""
        poses = self._bench.poses(SCREENING_SEEDS, WIDER)
        for index, pose in enumerate(poses):
            self._progress("Finding what the robot can touch", 0.05 + 0.3 * index / len(poses))
            yield pose

    def _proposer(self, places: Places) -> TaskProposer:
        bench = self._bench
        return TaskProposer(
            bench.mesh, places, bench.eye, bench.scenario.target_position, self._is_readable
        )

    def _is_readable(self, proposal: Proposal) -> bool:
        return place_marks(self._skin, proposal.fiducials, LABELS).has_room

    def _missed(self, proposals: list[Proposal]) -> np.ndarray:
        """Return the fiducials (n, 3) that cannot be touched in poses other than those tried."""
        fiducials = np.unique(np.concatenate([p.fiducials for p in proposals]), axis=0)
        normals = np.array([outward_normal(self._bench.mesh, point) for point in fiducials])
        can_be = self._bench.touchable(fiducials, normals, self._bench.poses(CHECK_SEEDS))
        return fiducials[~can_be]


def _plans(attempt: int) -> list[TaskPlan]:
    """Return the plans, the easy ones with more room after failures."""
    wider = WIDEN_DEG * attempt
    return [
        replace(plan, off_axis_deg=min(WIDEST_DEG, plan.off_axis_deg + wider)) for plan in PLANS
    ]


def _task(proposal: Proposal) -> Task:
    plan = proposal.plan
    return Task(
        plan.name, plan.title, LABELS, proposal.fiducials, round(proposal.complexity.index, 2)
    )
