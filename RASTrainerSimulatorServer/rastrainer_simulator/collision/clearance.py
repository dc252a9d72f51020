"""How near the arm is to what it must not run into: the values of one check."""

from __future__ import annotations

from typing import NamedTuple

from rastrainer_simulator.vectors import Vector

FAR = 0.1
"""Clearances of links, self and table are exact up to here, m; what is farther counts as FAR."""

SHAFT_NEAR = 0.0015
"""The shaft's clearance is exact up to here, m, and wherever it is less than the tip's: only then
does it say more than the tip's does."""


class Nearest(NamedTuple):
    """The place of the head's surface that is nearest to the tip or to the shaft.

    Attributes:
        distance_m: signed clearance, m; below zero inside the head.
        point: on the surface, m.
        normal: unit vector away from the head: the way in which the clearance grows.
        triangle: of the head's surface, by its number.
    """

    distance_m: float
    point: Vector
    normal: Vector
    triangle: int


class Clearance(NamedTuple):
    """Signed clearances of one posture, in m (below zero: overlap); points and normals in World.

    Attributes:
        tip: the very tip of the tool against the head.
        shaft: the rest of the tool against the head, where it is near (see `SHAFT_NEAR`), else
            None; it starts 3 mm behind the tip.
        links_m: the links, flange included, against the head; at most FAR.
        links_worst: the link that is nearest to the head, "" where none is within FAR.
        self_m: the arm against itself, links at least three joints apart; at most FAR.
        self_worst: the two links nearest to each other, () where none are within FAR.
        table_m: arm and tool against the table and the head's stand; at most FAR.
        table_worst: the link nearest to them, "" where none is within FAR.
    """

    tip: Nearest
    shaft: Nearest | None
    links_m: float
    links_worst: str
    self_m: float
    self_worst: tuple[str, ...]
    table_m: float
    table_worst: str

    @property
    def tip_m(self) -> float:
        """Signed clearance of the tip to the head, m."""
        return self.tip.distance_m

    @property
    def shaft_m(self) -> float:
        """Signed clearance of the tool without its tip to the head, m; at least so much if far."""
        return max(self.tip_m, SHAFT_NEAR) if self.shaft is None else self.shaft.distance_m

    @property
    def tool_m(self) -> float:
        """Signed clearance of the whole tool to the head, m: what the trainee is shown."""
        return min(self.tip_m, self.shaft_m)

    @property
    def without_tip_m(self) -> float:
        """The least clearance of everything but the tip: a touch is possible where it is > 0."""
        return min(self.shaft_m, self.links_m, self.self_m, self.table_m)

    @property
    def worst(self) -> str:
        """The nearest part: "tip", "shaft", "links", "self" or "table"."""
        parts = ("tip", "shaft", "links", "self", "table")
        return min(parts, key=lambda part: getattr(self, f"{part}_m"))
