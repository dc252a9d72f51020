"""From the control loop's thread to the event loop's, never waiting and never queueing."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

from rastrainer_simulator.state import SimulationState, StepResult


class StateFeed:
    """Subscriber of the control loop that hands over the newest state whenever one is due."""

    def __init__(
        self,
        is_due: Callable[[SimulationState], bool],
        deliver: Callable[[SimulationState], None],
        loop: asyncio.AbstractEventLoop,
    ):
        """`is_due` is asked at every tick, in its thread; `deliver` is called in that of `loop`."""
        self._is_due = is_due
        self._deliver = deliver
        self._loop = loop
        self._newest: SimulationState | None = None
        self._is_handed_over = False

    def __call__(self, result: StepResult) -> None:
        """Note a tick's state; called in the control loop's thread."""
        self._newest = result.state
        if not self._is_handed_over and self._is_due(result.state):
            self._is_handed_over = True
            self._loop.call_soon_threadsafe(self._hand_over)

    def _hand_over(self) -> None:
        self._is_handed_over = False
        self._deliver(self._newest)
