"""From the control loop's thread to the event loop's, never waiting and never queueing."""

from __future__ import annotations

import asyncio

from rastrainer_simulator.igtl.publisher import Publisher
from rastrainer_simulator.state import SimulationState, StepResult


class StateFeed:
    """Subscriber of the control loop that hands the publisher the newest state when one is due."""

    def __init__(self, publisher: Publisher, loop: asyncio.AbstractEventLoop):
        self._publisher = publisher
        self._loop = loop
        self._newest: SimulationState | None = None
        self._is_handed_over = False

    def __call__(self, result: StepResult) -> None:
        """Note a tick's state; called in the control loop's thread."""
        self._newest = result.state
        if not self._is_handed_over and self._publisher.is_due(result.state):
            self._is_handed_over = True
            self._loop.call_soon_threadsafe(self._deliver)

    def _deliver(self) -> None:
        self._is_handed_over = False
        self._publisher.publish(self._newest)
