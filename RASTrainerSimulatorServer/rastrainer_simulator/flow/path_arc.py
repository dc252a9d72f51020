"""How far the tip is from the path to the next fiducial, and in which direction it has to go."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.teleoperation.axes import Axes
from rastrainer_simulator.vectors import (
    Vector,
    cross,
    distance,
    dot,
    length,
    scale,
    subtract,
    unit,
)

FARTHEST = 0.045
"""Beside the way up to which the tip is on it, m."""
BACK_WITHIN = 0.03
"""Beside the way from which it is on it again, m."""
ABOVE_LEAST = 0.35
"""Share of the largest component from which another one is worth a word."""

_WORDS = (("left", "right"), ("back", "forward"), ("down", "up"))


@dataclass(frozen=True)
class PathArc:
    """The way over the head from one point to the next (World, m).

    The tool is lifted, carried around the head and lowered: the way is the arc about the head's
    center from one to the other, at any height.
    """

    center: Vector
    start: Vector
    end: Vector

    def beside(self, tip: Vector) -> float:
        """Return how far the tip is beside the way, along the head, in m."""
        out = subtract(tip, self.center)
        first, last, here = (unit(subtract(p, self.center)) for p in (self.start, self.end, tip))
        return length(out) * _angle_to_arc(here, first, last)


def _angle_to_arc(here: Vector, first: Vector, last: Vector) -> float:
    """Return the angle in rad from a direction to the shorter arc between two others."""
    pole = unit(cross(first, last))
    to_ends = min(_angle(here, first), _angle(here, last))
    if length(pole) == 0.0:
        return to_ends
    is_between = dot(cross(pole, first), here) >= 0.0 and dot(cross(last, pole), here) >= 0.0
    return abs(math.asin(max(-1.0, min(1.0, dot(here, pole))))) if is_between else to_ends


def _angle(a: Vector, b: Vector) -> float:
    return 2.0 * math.asin(min(1.0, 0.5 * distance(a, b)))


def direction_words(tip: Vector, target: Vector, axes: Axes) -> tuple[str, ...]:
    """Return which ways the tip has to go, as the operator sees it, the longest first.

    Each is "left", "right", "back", "forward", "down" or "up"; a short part has no word.
    """
    away = subtract(target, tip)
    parts = [
        (dot(away, axis), words)
        for axis, words in zip((axes.right, axes.forward, axes.up), _WORDS, strict=True)
    ]
    largest = max(abs(part) for part, _ in parts)
    named = [each for each in parts if abs(each[0]) > ABOVE_LEAST * largest]
    named.sort(key=lambda each: -abs(each[0]))
    return tuple(words[part > 0.0] for part, words in named)


def in_m(point_mm: Iterable[float]) -> Vector:
    """Return a point that is given in mm in m."""
    x, y, z = point_mm
    return scale((float(x), float(y), float(z)), 1.0 / MM_PER_M)
