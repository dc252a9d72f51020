"""Propose the fiducials of a task, and their order, among the places that the robot can touch."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.complexity import Complexity, complexity, is_hidden
from rastrainer.errors import InputError
from rastrainer.head_mesh import HeadMesh
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.surface_path import SurfaceGraph
from rastrainer_simulator.planning.touch_order import (
    arc_lengths,
    crossing_order,
    easiest_order,
    ways_between,
)

SPACING_MM = 20.0
"""Between any two fiducials of a task: numbers must not cover each other."""

DRAWS = 30
"""Random choices of fiducials, of which the one that locates the target best is taken."""

RISE = 1.1
"""Each task's complexity index is at least so many times that of the task before."""

ATTEMPTS = 20


@dataclass(frozen=True)
class TaskPlan:
    """What a task shall demand.

    Attributes:
        name, title: of the task.
        hidden: how many fiducials the default view shall not show.
        off_axis_deg: how far the normals of those that it shows may be from the view's direction.
        crossings: how often the way changes between the right and the left half; 0 takes the
            easiest way over all.
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
class Places:
    """Where fiducials may be; RAS mm.

    Attributes:
        positions, normals: (n, 3) float.
        off_axis_deg: (n,) float, between each normal and the direction to the default view's eye.
        hidden: (n,) bool, the places that this view does not show.
    """

    positions: np.ndarray
    normals: np.ndarray
    off_axis_deg: np.ndarray
    hidden: np.ndarray


@dataclass(frozen=True)
class Proposal:
    """Fiducials (15, 3) float, RAS mm, in the order to touch, and how demanding that is."""

    plan: TaskPlan
    fiducials: np.ndarray
    complexity: Complexity


def places_seen_from(
    mesh: HeadMesh, positions: np.ndarray, normals: np.ndarray, eye: np.ndarray
) -> Places:
    """Return the places with what the default view, from `eye` (3,) RAS mm, shows of them."""
    toward = eye - positions
    toward /= np.linalg.norm(toward, axis=1, keepdims=True)
    cosines = np.einsum("ij,ij->i", normals, toward)
    hidden = [is_hidden(*place, mesh, eye) for place in zip(positions, normals, strict=True)]
    return Places(
        positions, normals, np.degrees(np.arccos(np.clip(cosines, -1, 1))), np.array(hidden)
    )


class TaskProposer:
    """Proposes tasks on one head; the same seed proposes the same task."""

    def __init__(
        self,
        mesh: HeadMesh,
        places: Places,
        eye: np.ndarray,
        target: np.ndarray,
        accepts: Callable[[Proposal], bool] = lambda _proposal: True,
    ) -> None:
        """Keep the places; what is proposed in a row is what `accepts` agrees to."""
        self._mesh = mesh
        self._graph = SurfaceGraph(mesh)
        self._places = places
        self._eye = eye
        self._target = target
        self._accepts = accepts

    def propose_rising(
        self, plans: Sequence[TaskPlan], seed: int, begins_easy: bool = False
    ) -> list[Proposal]:
        """Return a task for each plan, each more demanding than the one before.

        Args:
            plans: what the tasks shall demand.
            seed: of the draws.
            begins_easy: take the easiest of many draws as the first task: where little of the
                head can be touched, the others are not much harder.

        Raises:
            InputError: there is no room for the fiducials, or none of many draws is so.
        """
        seeds = np.random.default_rng(seed).integers(0, 2**31, (len(plans), ATTEMPTS))
        proposals: list[Proposal] = []
        for plan, own_seeds in zip(plans, seeds.tolist(), strict=True):
            least = RISE * proposals[-1].complexity.index if proposals else 0.0
            draws = (self.propose(plan, own_seed) for own_seed in own_seeds)
            if begins_easy and not proposals:
                draws = iter(sorted(draws, key=lambda draw: draw.complexity.index))
            harder = (draw for draw in draws if draw.complexity.index >= least)
            rising = next(filter(self._accepts, harder), None)
            if rising is None:
                raise InputError(f"{plan.title} cannot be made harder than the task before it.")
            proposals.append(rising)
        return proposals

    def propose(self, plan: TaskPlan, seed: int) -> Proposal:
        """Return a task as planned.

        Raises:
            InputError: there is no room for so many fiducials.
        """
        chosen = self._chosen(plan, np.random.default_rng(seed))
        fiducials = self._places.positions[self._ordered(plan, chosen)]
        demands = complexity(fiducials, self._mesh, self._graph, self._eye)
        return Proposal(plan, fiducials, demands)

    def _chosen(self, plan: TaskPlan, random: np.random.Generator) -> list[int]:
        """Return the places of the draw, of several, that locates the target best."""
        places = self._places
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
        return min(draws, key=lambda chosen: target_spread(places.positions[chosen], self._target))

    def _spread(
        self, chosen: list[int], among: np.ndarray, count: int, random: np.random.Generator
    ) -> list[int]:
        """Add `count` places at random, none nearer than the spacing to another."""
        chosen = list(chosen)
        for place in random.permutation(among) if count else ():
            away = self._places.positions[chosen] - self._places.positions[place]
            if len(chosen) == 0 or np.linalg.norm(away, axis=1).min() >= SPACING_MM:
                chosen.append(int(place))
                count -= 1
                if count == 0:
                    break
        return chosen

    def _ordered(self, plan: TaskPlan, chosen: list[int]) -> list[int]:
        positions, normals = self._places.positions[chosen], self._places.normals[chosen]
        ways = ways_between(positions, normals, arc_lengths(positions, normals))
        if plan.crossings == 0:
            order = easiest_order(ways, list(range(len(chosen))))
        else:
            by_side = np.argsort(-positions[:, 0], kind="stable").tolist()
            half = (len(chosen) + 1) // 2
            sides = [by_side[:half], by_side[half:]]
            order = crossing_order(ways, sides, plan.crossings)
        return [chosen[index] for index in order]


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
