"""How a procedure's planned line is looked at: along the guide, and from across."""

from __future__ import annotations

import math
from typing import NamedTuple

from rastrainer_simulator.trial_state import GuideAxis, PlannedLine
from rastrainer_simulator.vectors import (
    Vector,
    add,
    any_perpendicular,
    cross,
    dot,
    length,
    reject,
    scale,
    subtract,
    unit,
)
from rastrainer_simulator.viewpoint.view_control import CameraPose, Pictures

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


AWAY_M = 0.4
MARGIN_M = 0.02
TALLEST_M = 0.34
"""The greatest height of what the picture shows: a tool that is far away is not in it."""
UP: Vector = (0.0, 0.0, 1.0)


def across_line(eye: Vector, line: PlannedLine, tip: Vector) -> CameraPose:
    """Return the camera that looks across a planned line, from the side of another eye.

    In its picture the instrument comes from above. It shows the whole line, and the tool's tip
    where that is near. World, m.
    """
    middle = scale(add(line.entry, line.target), 0.5)
    across = cross(line.direction, reject(UP, line.direction))
    if length(across) < MARGIN_M:
        across = any_perpendicular(line.direction)
    across = unit(across)
    beside = [add(middle, scale(across, way * AWAY_M)) for way in (1.0, -1.0)]
    nearer = min(beside, key=lambda place: math.dist(place, eye))
    farthest = max(math.dist(middle, end) for end in (line.entry, line.target, tip))
    height = min(2.0 * (farthest + MARGIN_M), TALLEST_M)
    angle_deg = math.degrees(2.0 * math.atan(0.5 * height / AWAY_M))
    return CameraPose(nearer, middle, scale(line.direction, -1.0), angle_deg)
