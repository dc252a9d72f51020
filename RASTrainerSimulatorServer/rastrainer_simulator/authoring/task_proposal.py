"""Propose a trial run and five tasks for any head: fiducials that can be touched, in an order."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, outward_normals
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.scenario.points import LABELS, Task
from rastrainer.work_progress import Progress, no_progress
from rastrainer_simulator.authoring.face_removal import face_vertices
from rastrainer_simulator.authoring.planning_setup import POSES_TRIED, WIDER, PlanningSetup
from rastrainer_simulator.authoring.touch_order import (
    Complexity,
    SurfaceGraph,
    arc_lengths,
    complexity,
    crossing_order,
    easiest_order,
    is_hidden,
    transitions_between,
)
from rastrainer_simulator.scene.skin_marks import Skin, place_marks

SPACING_MM = 20.0
"""Least distance of two fiducials of a task: numbers must not cover each other."""

DRAWS = 30
"""Number of random choices of fiducials, the best of which (by target TRE) is used."""

RISE = 1.1
"""Least ratio of the complexity indices of a task and of the task before it."""

ATTEMPTS = 20
ROUGHLY = 0.8
"""A draw whose estimated index is below this share of the required one is not measured."""


@dataclass(frozen=True)
class TaskPlan:
    """The demands of a task.

    Attributes:
        hidden: number of fiducials that the default view does not show.
        off_axis_deg: largest angle between the normal of a shown fiducial and the view's direction.
        crossings: how often the order changes between the right and the left half; 0 for the
            easiest order.
    """

    name: str
    title: str
    hidden: int
    off_axis_deg: float
    crossings: int


PLANS = (
    TaskPlan("trial-run", "Trial run", hidden=0, off_axis_deg=50.0, crossings=0),
    TaskPlan("task-1", "Task 1", hidden=0, off_axis_deg=75.0, crossings=0),
    TaskPlan("task-2", "Task 2", hidden=3, off_axis_deg=75.0, crossings=0),
    TaskPlan("task-3", "Task 3", hidden=6, off_axis_deg=75.0, crossings=0),
    TaskPlan("task-4", "Task 4", hidden=8, off_axis_deg=75.0, crossings=4),
    TaskPlan("task-5", "Task 5", hidden=9, off_axis_deg=75.0, crossings=9),
)


@dataclass(frozen=True)
class CandidatePlaces:
    """Candidate points for fiducials; RAS mm.

    Attributes:
        positions, normals: (n, 3) float.
        off_axis_deg: (n,) float, between each normal and the direction to the default view's eye.
        hidden: (n,) bool, whether this view does not show the point.
    """

    positions: np.ndarray
    normals: np.ndarray
    off_axis_deg: np.ndarray
    hidden: np.ndarray


@dataclass(frozen=True)
class Proposal:
    """Fiducials (15, 3) float, RAS mm, in the order to touch, and their complexity."""

    plan: TaskPlan
    fiducials: np.ndarray
    complexity: Complexity


def places_seen_from(
    mesh: HeadMesh, positions: np.ndarray, normals: np.ndarray, eye: np.ndarray
) -> CandidatePlaces:
    """Return candidates with their visibility in the default view, from `eye` (3,) RAS mm."""
    toward = eye - positions
    toward /= np.linalg.norm(toward, axis=1, keepdims=True)
    cosines = np.einsum("ij,ij->i", normals, toward)
    hidden = [is_hidden(*place, mesh, eye) for place in zip(positions, normals, strict=True)]
    return CandidatePlaces(
        positions, normals, np.degrees(np.arccos(np.clip(cosines, -1, 1))), np.array(hidden)
    )


class TaskProposer:
    """Proposes tasks on one head; the same seed proposes the same task."""

    def __init__(
        self,
        graph: SurfaceGraph,
        places: CandidatePlaces,
        eye: np.ndarray,
        target: np.ndarray,
        accepts: Callable[[np.ndarray], bool] = lambda _fiducials: True,
        usable: Callable[[np.ndarray], np.ndarray] = lambda places: np.ones(len(places), bool),
    ) -> None:
        """Prepare proposals for the default view's eye and a target to be located well, RAS mm.

        `usable` returns which of some points (n, 3) can be used, (n,) bool; it is expensive, so it
        is called for chosen points only, and unusable points are not chosen again.
        """
        self._graph, self._places = graph, places
        self._eye, self._target = eye, target
        self._accepts, self._usable = accepts, usable

    def propose_rising(
        self, plans: Sequence[TaskPlan], seed: int, begins_easy: bool = False
    ) -> list[Proposal]:
        """Return a task for each plan, each more demanding than its predecessor.

        With `begins_easy` the first task is the easiest of many draws, for a head of which little
        can be touched: there the others are not much harder.
        """
        seeds = np.random.default_rng(seed).integers(0, 2**31, (len(plans), ATTEMPTS))
        proposals: list[Proposal] = []
        for plan, own_seeds in zip(plans, seeds.tolist(), strict=True):
            least = RISE * proposals[-1].complexity.index if proposals else 0.0
            if begins_easy and not proposals:
                own_seeds = sorted(own_seeds, key=lambda seed: self._draw(plan, seed)[1])
            found = (self.propose(plan, own_seed, least) for own_seed in own_seeds)
            rising = next((one for one in found if one and self._accepts(one.fiducials)), None)
            if rising is None:
                raise InputError(f"{plan.title} cannot be made harder than the task before it.")
            proposals.append(rising)
        return proposals

    def propose(self, plan: TaskPlan, seed: int, least: float = 0.0) -> Proposal | None:
        """Return a task as planned; None if its complexity index is below `least`."""
        while True:
            fiducials, rough_index = self._draw(plan, seed)
            is_usable = self._usable(fiducials)
            if is_usable.all():
                break
            # Draw again without the unusable points.
            useless = fiducials[~is_usable]
            kept = ~(self._places.positions[:, None] == useless[None]).all(axis=2).any(axis=1)
            self._places = CandidatePlaces(
                *(values[kept] for values in vars(self._places).values())
            )
        if rough_index < ROUGHLY * least:
            return None
        demands = complexity(fiducials, self._graph, self._eye)
        return Proposal(plan, fiducials, demands) if demands.index >= least else None

    def _draw(self, plan: TaskPlan, seed: int) -> tuple[np.ndarray, float]:
        """Return fiducials (15, 3) in the order to touch, and an estimate of their index."""
        places, random = self._places, np.random.default_rng(seed)
        shown = np.flatnonzero(~places.hidden & (places.off_axis_deg <= plan.off_axis_deg))
        hidden = np.flatnonzero(places.hidden)
        draws = []
        for _ in range(DRAWS):
            chosen = self._spread([], shown, FIDUCIAL_COUNT - plan.hidden, random)
            chosen = self._spread(chosen, hidden, plan.hidden, random)
            if len(chosen) == FIDUCIAL_COUNT:
                draws.append(chosen)
        if not draws:
            raise InputError(
                f"The head has no room for the fiducials of {plan.title}: too few places are "
                "smooth, within the robot's reach and far enough from each other."
            )
        # This draw locates the target best.
        best = min(draws, key=lambda draw: target_spread(places.positions[draw], self._target))
        positions, normals = places.positions[best], places.normals[best]
        transitions = transitions_between(positions, normals, arc_lengths(positions, normals))
        if plan.crossings == 0:
            order = easiest_order(transitions, list(range(len(positions))))
        else:
            by_side = np.argsort(-positions[:, 0], kind="stable").tolist()
            half = (len(positions) + 1) // 2
            sides = [by_side[:half], by_side[half:]]
            order = crossing_order(transitions, sides, plan.crossings)
        return positions[order], float(transitions.costs([order])[0]) + plan.hidden

    def _spread(
        self, chosen: list[int], among: np.ndarray, count: int, random: np.random.Generator
    ) -> list[int]:
        """Add `count` random candidates, none nearer to another than the spacing."""
        chosen = list(chosen)
        for place in random.permutation(among) if count else ():
            away = self._places.positions[chosen] - self._places.positions[place]
            if len(chosen) == 0 or np.linalg.norm(away, axis=1).min() >= SPACING_MM:
                chosen.append(int(place))
                count -= 1
                if count == 0:
                    break
        return chosen


def target_spread(fiducials: np.ndarray, target: np.ndarray) -> float:
    """Return E[TRE²] / E[FLE²] at a target: ⅓ tr(I/N + [r]ₓ J⁻¹ [r]ₓᵀ) (Fitzpatrick 1998).

    J is the inertia of the fiducials (n, 3), r the target (3,) from their centroid.
    """
    center = fiducials.mean(axis=0)
    points, (x, y, z) = fiducials - center, target - center
    scatter = points.T @ points
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    inertia = np.trace(scatter) * np.eye(3) - scatter
    covariance = np.eye(3) / len(points) + cross @ np.linalg.inv(inertia) @ cross.T
    return float(np.trace(covariance) / 3.0)


ABOVE_BASE_MM = 25.0
SMOOTH_WITHIN_MM = 12.0
MAX_BENDING_DEG = 30.0
"""Most that a normal within that distance may differ: excludes ears, nostrils, eyelids, brows."""

DOWNWARD = -0.4
"""A point whose normal has a lower S than this cannot be seen or touched well."""


def smooth_places(mesh: HeadMesh, spacing_mm: float) -> np.ndarray:
    """Return the indices (n,) of vertices where the skin is smooth, `spacing_mm` apart.

    Each next one is the farthest from those before it (farthest point sampling).
    """
    height = mesh.vertices[:, 2] - mesh.vertices[:, 2].min()
    allowed = (height > ABOVE_BASE_MM) & (mesh.vertex_normals[:, 2] > DOWNWARD)
    allowed = np.flatnonzero(allowed)
    points = mesh.vertices[allowed]
    chosen, nearest = [int(points[:, 2].argmax())], np.full(len(points), np.inf)
    while True:
        nearest = np.minimum(nearest, np.linalg.norm(points - points[chosen[-1]], axis=1))
        if nearest.max() < spacing_mm:
            break
        chosen.append(int(nearest.argmax()))
    smooth, least = [], np.cos(np.radians(MAX_BENDING_DEG))
    for vertex in allowed[chosen]:
        away = np.linalg.norm(mesh.vertices - mesh.vertices[vertex], axis=1)
        around = mesh.vertex_normals[away < SMOOTH_WITHIN_MM]
        if (around @ mesh.vertex_normals[vertex]).min() >= least:
            smooth.append(vertex)
    return np.array(smooth)


PLACE_SPACING_MM = 11.0
FACE_MARGIN_MM = 10.0
"""Least distance of fiducials from the face, so that it can be removed without moving any."""

WIDE_SEEDS, TRIAL_SEEDS = range(1000, 1024), range(POSES_TRIED)
"""Seeds of the poses in which a fiducial must be touchable: wider than in trials, and the poses of
the check. If only six were wide, a fiducial was out of reach in 1 of 1,000 trials."""

SETS_TRIED = 6
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
    for attempt in range(SETS_TRIED):
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
            return tuple(
                planning.measured(one.plan.name, one.plan.title, one.fiducials) for one in proposals
            )
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
