"""How far the tip may go: up to the surface, and along it, never behind a plane of contact."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

from rastrainer_simulator.collision.clearance import Nearest
from rastrainer_simulator.vectors import (
    Vector,
    add,
    cross,
    distance,
    dot,
    length,
    scale,
    shortened,
    subtract,
)

_INSIDE = 1e-10
_PARALLEL = 1e-9


class HalfSpace(NamedTuple):
    """All points x with normal · x ≥ bound; the normal is a unit vector."""

    normal: Vector
    bound: float


def nearest_inside(goal: Vector, half_spaces: Sequence[HalfSpace]) -> Vector | None:
    """Return the point in all half-spaces that is nearest to `goal`, None where there is none.

    It lies on none, one, two or three of the planes, and is the nearest of the feasible points
    found by trying them all: with the handful of planes of a contact that takes microseconds.
    """
    if _is_inside(goal, half_spaces):
        return goal
    feasible = [point for point in _candidates(goal, half_spaces) if _is_inside(point, half_spaces)]
    return min(feasible, key=lambda point: distance(point, goal), default=None)


def _is_inside(point: Vector, half_spaces: Sequence[HalfSpace]) -> bool:
    return all(dot(normal, point) >= bound - _INSIDE for normal, bound in half_spaces)


def _candidates(goal: Vector, half_spaces: Sequence[HalfSpace]) -> Iterator[Vector]:
    for normal, bound in half_spaces:
        yield add(goal, scale(normal, bound - dot(normal, goal)))
    for first, second in combinations(half_spaces, 2):
        along = dot(first.normal, second.normal)
        sine_squared = 1.0 - along * along
        if sine_squared < _PARALLEL:
            continue
        a = first.bound - dot(first.normal, goal)
        b = second.bound - dot(second.normal, goal)
        share_1, share_2 = (a - along * b) / sine_squared, (b - along * a) / sine_squared
        yield add(goal, add(scale(first.normal, share_1), scale(second.normal, share_2)))
    for first, second, third in combinations(half_spaces, 3):
        across = cross(second.normal, third.normal)
        volume = dot(first.normal, across)
        if abs(volume) < _PARALLEL:
            continue
        corner = add(
            scale(across, first.bound),
            add(
                scale(cross(third.normal, first.normal), second.bound),
                scale(cross(first.normal, second.normal), third.bound),
            ),
        )
        yield scale(corner, 1.0 / volume)


REST = 1e-5
"""Clearance, m, at which a pressed tip rests: it never crosses, yet counts as touching."""

LONGEST_STEP = 5e-4
"""The tip passes near surfaces in steps, m, so short that it cannot jump through an ear."""

RECOVERY = 2e-4
"""How far, m a tick, a tip that is inside (the head was put there) is moved toward the outside."""

_TRIALS = 5
_STANDSTILL = 1e-9
_EXACT = 1e-8


@dataclass(frozen=True)
class Slide:
    """Where the tip may go, and the planes (World) that limit it there."""

    position: Vector
    half_spaces: tuple[HalfSpace, ...]


def slide(
    nearest_to_point: Callable[[Vector], Nearest],
    tip: Vector,
    here: Nearest,
    displacement: Vector,
    others: Sequence[HalfSpace],
) -> Slide:
    """Return the path of a tip at `tip` (World, m) that is to move by `displacement`.

    `here` is the head's surface nearest to the tip, `others` what limits the tip besides. At each
    step the tip moves toward the point nearest to its goal that is on the free side of the
    surface's tangent planes: at the tip, and wherever a trial ended inside. In a groove two planes
    hold it, in a pit three, so that it comes to rest there instead of jumping from wall to wall
    (the god object of Zilles and Salisbury 1995, 10.1109/IROS.1995.525876).
    """
    goal = add(tip, displacement)
    rest = min(REST, here.distance_m + RECOVERY)
    position, planes = tip, tuple(others)
    for _ in range(math.ceil(length(displacement) / LONGEST_STEP)):
        free = here.distance_m - rest
        if distance(position, goal) <= free:  # Within a ball that holds nothing of the head.
            return Slide(nearest_inside(goal, others) or position, tuple(others))
        planes = (_tangent(here, rest), *others)
        step = _step(nearest_to_point, position, goal, planes, max(free, LONGEST_STEP), rest)
        if step is None:
            break
        reached, here, planes = step
        moved = distance(position, reached)
        position = reached
        if moved < _STANDSTILL:
            break
    return Slide(position, planes)


def _step(
    nearest_to_point: Callable[[Vector], Nearest],
    position: Vector,
    goal: Vector,
    planes: tuple[HalfSpace, ...],
    longest: float,
    rest: float,
) -> tuple[Vector, Nearest, tuple[HalfSpace, ...]] | None:
    """Return the end of one step toward the goal, what is nearest there, and what limits it."""
    for _ in range(_TRIALS):
        target = nearest_inside(goal, planes)
        if target is None:
            break
        short = add(position, shortened(subtract(target, position), longest))
        # From a point nearer than `rest`, part of the displacement only leads part of the way out.
        trial = nearest_inside(short, planes) or short
        there = nearest_to_point(trial)
        if there.distance_m >= rest - _EXACT:
            return trial, there, planes
        planes = (*planes, _tangent(there, rest))
    return None


def _tangent(nearest: Nearest, rest: float) -> HalfSpace:
    return HalfSpace(nearest.normal, dot(nearest.normal, nearest.point) + rest)
