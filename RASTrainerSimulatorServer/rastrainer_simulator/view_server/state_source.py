"""Where the views' states come from."""

from __future__ import annotations

from collections.abc import Callable
from typing import Protocol

from rastrainer_simulator.loop_statistics import LoopStatistics
from rastrainer_simulator.setup import SimulationSetup
from rastrainer_simulator.state import SimulationState, StepResult


class StateSource(Protocol):
    """A control loop, a film that is played, or what changes between the two."""

    @property
    def latest(self) -> SimulationState:
        """The newest state."""

    @property
    def setup(self) -> SimulationSetup:
        """Head and robot."""

    @property
    def statistics(self) -> LoopStatistics:
        """How punctual the control loop has been."""

    def subscribe(self, callback: Callable[[StepResult], None]) -> Callable[[], None]:
        """Have `callback` called with each state, in any thread; returns what ends that."""
