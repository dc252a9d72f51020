"""How the robot brings the guide onto a planned line: around the head, by its rough outline."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

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


_BANDS = 12
"""Of latitude; there are twice as many sectors of longitude."""


class HeadOutline:
    """The greatest distance of the skin from the middle of the head, by sectors of 15°.

    Attributes:
        middle: of the head, RAS mm.
    """

    def __init__(self, vertices: np.ndarray, middle: np.ndarray) -> None:
        """Take the head's vertices, (n, 3) float, and its middle, (3,) float, RAS mm."""
        self.middle = middle
        out = vertices - middle
        radii = np.linalg.norm(out, axis=1)
        bands, sectors = _sectors(out / radii[:, None])
        table = np.zeros((_BANDS, 2 * _BANDS))
        np.maximum.at(table, (bands, sectors), radii)
        # A direction may lie at the edge of its sector: the neighbors count, too.
        wide = np.maximum.reduce([np.roll(table, turn, axis=1) for turn in (-1, 0, 1)])
        tall = np.pad(wide, ((1, 1), (0, 0)), mode="edge")
        # Whole millimeters: the same on every computer.
        radii_mm = np.ceil(np.maximum.reduce([tall[:-2], tall[1:-1], tall[2:]]))
        for pole in (0, -1):
            radii_mm[pole] = radii_mm[pole].max()
        self._radii = (radii_mm / 1000.0).tolist()

    def radius(self, direction: Vector) -> float:
        """Return the distance in a direction (unit vector in the head's frame), m."""
        x, y, z = direction
        band = _BANDS * math.acos(min(max(z, -1.0), 1.0)) / math.pi
        sector = _BANDS * (math.atan2(y, x) + math.pi) / math.pi
        return self._radii[min(int(band), _BANDS - 1)][min(int(sector), 2 * _BANDS - 1)]


def _sectors(directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the band and the sector of unit vectors, (n,) int each."""
    x, y, z = directions.T
    bands = (_BANDS * np.arccos(np.clip(z, -1.0, 1.0)) / np.pi).astype(int)
    sectors = (_BANDS * (np.arctan2(y, x) + np.pi) / np.pi).astype(int)
    return np.minimum(bands, _BANDS - 1), np.minimum(sectors, 2 * _BANDS - 1)
