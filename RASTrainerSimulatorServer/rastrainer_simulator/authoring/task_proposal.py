"""Propose the fiducials of a task and their order, among points that the robot can touch."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.protocol import FIDUCIAL_COUNT
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
