"""A move of the arm by itself over the head: up, across, down and to its goal."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import OperatorInput
from rastrainer_simulator.vectors import Vector, distance

PASSED_M = 0.005
"""A waypoint this near is passed; the goal itself is reached within `REACHED_M`."""
REACHED_M = 0.0005
SPEED_MM_S = 250.0
LONGEST_S = 10.0
STALLED_S = 0.8
"""Without progress for so long, the arm is stopped by the head or by itself."""
TAKEN_OVER = 0.2
"""A stick that is pushed farther counts as intended."""


@dataclass(eq=False)
class ArmMove:
    """Moves the tip along waypoints (World, m), the last of which is its goal.

    Using the sticks ends it. Times are the simulation's: a slow one gives the arm no less time.

    Attributes:
        move_tip: begins a move of the tip to a place in mm, with a speed in mm/s.
        blocked_mm: how far the arm was stopped before its goal; 0 if it was not stopped.
    """

    move_tip: Callable[[list[float], float], None]
    way: list[Vector]
    is_over: bool = False
    blocked_mm: float = 0.0
    _left_s: float = LONGEST_S
    _stalled_s: float = 0.0
    _nearest: float = math.inf
    _commanded: Vector | None = None

    def advance(self, dt: float, tip: Vector, sticks: OperatorInput) -> None:
        self._left_s -= dt
        self._stalled_s += dt
        while len(self.way) > 1 and distance(tip, self.way[0]) < PASSED_M:
            del self.way[0]
        away = distance(tip, self.way[0])
        if self._commanded != self.way[0]:
            self._commanded, self._nearest = self.way[0], math.inf
            self.move_tip([MM_PER_M * value for value in self.way[0]], SPEED_MM_S)
        if away < self._nearest - REACHED_M / 10.0:
            self._nearest, self._stalled_s = away, dt
        is_stalled = self._stalled_s > STALLED_S or self._left_s < 0.0
        is_taken_over = max(map(abs, sticks.translation)) > TAKEN_OVER
        is_there = len(self.way) == 1 and away < REACHED_M
        self.is_over = is_there or is_taken_over or is_stalled
        if is_stalled and not is_taken_over:
            self.blocked_mm = MM_PER_M * distance(tip, self.way[-1])
