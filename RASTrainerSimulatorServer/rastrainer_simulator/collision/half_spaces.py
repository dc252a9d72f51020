"""The nearest point that obeys a few planes, each with a side that is forbidden."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import combinations
from typing import NamedTuple

from rastrainer_simulator.vectors import Vector, add, cross, distance, dot, scale

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
