"""How the planned line lies to the guide, seen along its axis: the bull's-eye of all views."""

from __future__ import annotations

import math
from typing import NamedTuple

from rastrainer_simulator.procedure_state import GuideAxis, PlannedLine
from rastrainer_simulator.vectors import Vector, cross, dot, length, reject, subtract, unit
from rastrainer_simulator.viewpoint.view_control import Pictures

SIDEWAYS = 0.2
"""Sine of the angle between the guide and the picture's right, below which up decides."""


class Aim(NamedTuple):
    """Where entry and target of a planned line are beside the guide's axis: right and up, m.

    Right is that of the main picture, or of the eyes in a headset: a guide that is moved to the
    right goes to the right here. Up is across both.
    """

    entry: tuple[float, float]
    target: tuple[float, float]


def aim(guide: GuideAxis, line: PlannedLine, pictures: Pictures) -> Aim:
    """Return how a planned line lies to the guide."""
    across = reject(_right(pictures), guide.direction)
    if length(across) < SIDEWAYS:
        across = cross(guide.direction, reject(_up(pictures), guide.direction))
    right = unit(across)
    up = cross(right, guide.direction)

    def beside(point: Vector) -> tuple[float, float]:
        offset = subtract(point, guide.tip)
        return dot(offset, right), dot(offset, up)

    return Aim(beside(line.entry), beside(line.target))


def _right(pictures: Pictures) -> Vector:
    if pictures.yaw_deg is not None:
        yaw = math.radians(pictures.yaw_deg)
        return (math.sin(yaw), -math.cos(yaw), 0.0)
    main = pictures.main
    return unit(cross(subtract(main.focal_point, main.position), main.view_up))


def _up(pictures: Pictures) -> Vector:
    return (0.0, 0.0, 1.0) if pictures.yaw_deg is not None else pictures.main.view_up
