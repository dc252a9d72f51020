"""Propose a trial run and five tasks for any head."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, outward_normals
from rastrainer.scenario.points import LABELS, Task
from rastrainer.work_progress import Progress, no_progress
from rastrainer_simulator.authoring.face_removal import face_vertices
from rastrainer_simulator.authoring.planning_setup import WIDER, PlanningSetup
from rastrainer_simulator.authoring.scenario_check import measured
from rastrainer_simulator.authoring.task_proposal import (
    PLANS,
    CandidatePlaces,
    TaskProposer,
    places_seen_from,
)
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


def propose_tasks(
    planning: PlanningSetup, seed: int, progress: Progress = no_progress
) -> tuple[Task, ...]:
    """Return a set of tasks, each more demanding than its predecessor; the same for a seed.

    Their fiducials are on the skin, off the face, touchable in many poses of the head, and spread
    so that the target is located well; their numbers do not overlap. `progress` may raise to
    cancel.
    """
    share = 0.0

    def report(step: str, reached: float) -> None:
        nonlocal share
        share = max(share, min(reached, MAX_SHARE))
        progress(step, share)

    # In these, besides the nominal one, every fiducial must be touchable.
    poses = [*planning.poses(WIDE_SEEDS, WIDER)[1:], *planning.poses(TRIAL_SEEDS)[1:]]
    known: dict[tuple[float, ...], bool] = {}

    def are_touchable(positions: np.ndarray) -> np.ndarray:
        places = [tuple(position) for position in positions.tolist()]
        new = [place for place in places if place not in known]
        if new:
            report("Checking reach", 0.3 + 0.005 * len(known))
            normals = outward_normals(planning.mesh, np.array(new))
            can_be = planning.touchable(np.array(new), normals, poses)
            known.update(zip(new, can_be.tolist(), strict=True))
        return np.array([known[place] for place in places])

    places, skin, problem = _touchable_places(planning, report), Skin(planning.mesh), ""
    for attempt in range(ATTEMPTS):
        proposer = TaskProposer(
            planning.graph,
            places,
            planning.eye,
            planning.scenario.target.position_ras,
            lambda fiducials: place_marks(skin, fiducials, LABELS).has_room,
            are_touchable,
        )
        report("Placing fiducials", 0.3 + 0.1 * attempt)
        # Easy tasks have more room in each further attempt.
        wider = WIDEN_DEG * attempt
        plans = [
            replace(plan, off_axis_deg=min(WIDEST_DEG, plan.off_axis_deg + wider)) for plan in PLANS
        ]
        try:
            proposals = proposer.propose_rising(plans, seed + attempt, attempt > 0)
        except InputError as error:
            problem = str(error)
        else:
            return tuple(measured(planning, one.plan, one.fiducials) for one in proposals)
    raise InputError(problem)


def _touchable_places(
    planning: PlanningSetup, report: Callable[[str, float], None]
) -> CandidatePlaces:
    report("Finding smooth skin", 0.0)
    vertices = smooth_places(planning.mesh, PLACE_SPACING_MM)
    positions = planning.mesh.vertices[vertices].astype(float).round(_DECIMALS)
    normals = planning.mesh.vertex_normals[vertices]
    face = planning.mesh.vertices[face_vertices(planning.mesh)]
    if len(face):
        away = np.array([np.linalg.norm(face - place, axis=1).min() for place in positions])
        positions, normals = positions[away > FACE_MARGIN_MM], normals[away > FACE_MARGIN_MM]
    report("Finding what the robot can touch", 0.05)
    can_be = planning.touchable(positions, normals, planning.poses(range(0)))
    positions, normals = positions[can_be], normals[can_be]
    if len(positions) < len(LABELS):
        raise InputError(
            f"The robot can touch only {len(positions)} of {len(vertices)} places of this head "
            "where a fiducial could be; move the head closer to the robot."
        )
    report("Finding what the view shows", 0.2)
    return places_seen_from(planning.mesh, positions, normals, planning.eye)
