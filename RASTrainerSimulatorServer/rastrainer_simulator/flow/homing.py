"""Brings the arm to where trials start, by commands, for what is no trial."""

from __future__ import annotations

from rastrainer.protocol import CommandName
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.arm import start_tip
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.vectors import Vector, distance

NEAR_M = 0.02
"""From here on the arm counts as being there."""
SPEED_MM_S = 250.0
LONGEST_S = 6.0
TAKEN_OVER = 0.2
"""A stick that is pushed farther is meant."""


class Homing:
    """Moves the tip up, then across, and down to the start; who takes the sticks ends it."""

    def __init__(self, session: TrainingSession) -> None:
        self._session = session
        goal = start_tip(session.scenario, session.setup.settings.start_height)
        tip = session.tip
        high = max(tip[2], goal[2])
        self._way: list[Vector] = [(*tip[:2], high), (*goal[:2], high), goal]
        self._is_commanded = False
        self._left_s = LONGEST_S
        if distance(tip, goal) < NEAR_M:
            self._way.clear()

    @property
    def is_done(self) -> bool:
        """Whether the arm is there, or was taken over."""
        return not self._way

    def advance(self, dt: float) -> None:
        """Command the next part of the way once the one before is done."""
        session = self._session
        self._left_s -= dt
        is_taken_over = max(map(abs, session.held.translation)) > TAKEN_OVER
        if self._left_s < 0.0 or is_taken_over:
            self._way.clear()
        while self._way and distance(session.tip, self._way[0]) < NEAR_M / 4.0:
            del self._way[0]
            self._is_commanded = False
        if self._way and not self._is_commanded:
            self._is_commanded = True
            place = [MM_PER_M * value for value in self._way[0]]
            session.do(CommandName.MOVE_TIP_TO, {"positionMm": place, "speedMmS": SPEED_MM_S})
