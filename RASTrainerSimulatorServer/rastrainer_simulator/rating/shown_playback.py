"""One recorded trial after the other, as the views see them."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Callable

from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.precise_clock import LoopStatistics
from rastrainer_simulator.loop.results import Subscribers
from rastrainer_simulator.replay.playback import PERIOD_S, Playback
from rastrainer_simulator.state import SimulationState, StepResult


class ShownPlayback:
    """A `StateSource` of the playback that is shown now, in the event loop's thread.

    Attributes:
        playback: it.
    """

    statistics = LoopStatistics()

    def __init__(self, playback: Playback) -> None:
        self.playback = playback
        self._subscribers: Subscribers[StepResult] = Subscribers()
        self._end = playback.subscribe(self._subscribers.publish)

    @property
    def latest(self) -> SimulationState:
        """The state that is shown."""
        return self.playback.latest

    @property
    def setup(self) -> SimulationSetup:
        """Head and robot of the trial."""
        return self.playback.setup

    def subscribe(self, callback: Callable[[StepResult], None]) -> Callable[[], None]:
        """Have `callback` called with each state; returns what ends that."""
        return self._subscribers.add(callback)

    def show(self, playback: Playback) -> None:
        """Show another trial."""
        self._end()
        self.playback = playback
        self._end = playback.subscribe(self._subscribers.publish)

    async def run(self, advanced: Callable[[float], None]) -> None:
        """Play until it is canceled; `advanced` is called with the s that have gone by."""
        before = time.monotonic()
        while True:
            await asyncio.sleep(PERIOD_S)
            now = time.monotonic()
            self.playback.advance(now - before)
            advanced(now - before)
            before = now
