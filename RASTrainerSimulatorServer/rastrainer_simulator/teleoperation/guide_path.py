"""The way on which the robot brings the guide onto a planned line by itself: around the head."""

from __future__ import annotations

import math
from collections.abc import Callable

from rastrainer_simulator.procedure_state import GuideAxis, PlannedLine
from rastrainer_simulator.teleoperation.commanded_motion import MoveCommand, PathCommand
from rastrainer_simulator.vectors import (
    Vector,
    add,
    angle,
    distance,
    scale,
    subtract,
    turned_toward,
    unit,
)

TRAVEL_SPEED = 0.10
"""Of the tip around the head, m/s."""
APPROACH_SPEED = 0.03
"""Of the tip along the planned line, m/s."""
MARGIN = 0.03
"""How far the tip stays off the head on its way, m."""
STEP = math.radians(10.0)
"""Between two waypoints, seen from the middle of the head."""
_OUTWARD = 0.005

HeadRadius = Callable[[Vector], float]
"""Distance of the skin from the middle of the head in a direction (unit vector, World), m."""


def guide_path(
    guide: GuideAxis, line: PlannedLine, stand_off: float, middle: Vector, radius: HeadRadius
) -> PathCommand:
    """Return the path of the guide to `stand_off` m before a line's entry: out, around, and in.

    Args:
        guide: where it is.
        line: onto which it is brought, World.
        stand_off: from the tip to the entry at the end, m.
        middle: of the head by the registration in use, World, m.
        radius: of the head in each direction, by the same registration.
    """

    def outside(position: Vector) -> bool:
        out = subtract(position, middle)
        return distance(position, middle) >= radius(unit(out)) + MARGIN

    inward = line.direction
    end = subtract(line.entry, scale(inward, stand_off))
    begin = end
    while not outside(begin):
        begin = subtract(begin, scale(inward, _OUTWARD))
    first, last = unit(subtract(guide.tip, middle)), unit(subtract(begin, middle))
    turn = angle(first, last)
    start_radius = max(distance(guide.tip, middle), radius(first) + MARGIN)
    end_radius = distance(begin, middle)
    steps = max(1, math.ceil(turn / STEP))
    lean = angle(guide.direction, inward)
    waypoints = []
    for number in range(steps):
        share = number / steps
        out = turned_toward(first, last, share * turn)
        direct = (1.0 - share) * start_radius + share * end_radius
        place = add(middle, scale(out, max(direct, radius(out) + MARGIN)))
        direction = turned_toward(guide.direction, inward, share * lean)
        waypoints.append(MoveCommand(place, TRAVEL_SPEED, direction))
    return PathCommand(
        (
            *waypoints,
            MoveCommand(begin, TRAVEL_SPEED, inward),
            MoveCommand(end, APPROACH_SPEED, inward),
        )
    )
