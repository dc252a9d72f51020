"""From where a planned line is seen across: how deep guide, drill and instrument are on it."""

from __future__ import annotations

import math

from rastrainer_simulator.procedure_state import PlannedLine
from rastrainer_simulator.vectors import (
    Vector,
    add,
    any_perpendicular,
    cross,
    length,
    reject,
    scale,
    unit,
)
from rastrainer_simulator.viewpoint.orbit import CameraPose

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
