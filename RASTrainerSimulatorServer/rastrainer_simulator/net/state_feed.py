"""Pass the control loop's states to the event loop's thread without waiting."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from typing import Protocol

from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.timing import LoopStatistics
from rastrainer_simulator.state import EventKind, SimulationState, StepResult, TrainingState

_log = logging.getLogger(__name__)


class StateSource(Protocol):
    """A control loop, a playback, or what switches between the two."""

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
        """Call `callback` with each state, in any thread; return a function that unsubscribes."""


class StateFeed:
    """Subscriber of the control loop that delivers the newest state whenever one is due."""

    def __init__(
        self,
        is_due: Callable[[SimulationState], bool],
        deliver: Callable[[SimulationState], None],
        loop: asyncio.AbstractEventLoop,
    ):
        """`is_due` is called at every tick, in its thread; `deliver` in that of `loop`."""
        self._is_due = is_due
        self._deliver = deliver
        self._loop = loop
        self._newest: SimulationState | None = None
        self._is_scheduled = False

    def __call__(self, result: StepResult) -> None:
        """Note a tick's state; called in the control loop's thread."""
        self._newest = result.state
        if not self._is_scheduled and self._is_due(result.state):
            self._is_scheduled = True
            self._loop.call_soon_threadsafe(self._deliver_newest)

    def _deliver_newest(self) -> None:
        self._is_scheduled = False
        if self._newest is not None:
            self._deliver(self._newest)


class TrialLog:
    """Subscribes to a control loop; files are written in the event loop's thread only."""

    def __init__(self, loop: asyncio.AbstractEventLoop) -> None:
        self._loop = loop

    def __call__(self, result: StepResult) -> None:
        """Take a tick; called in the control loop's thread."""
        if any(event.kind is EventKind.PHASE for event in result.events):
            self._loop.call_soon_threadsafe(_note, result.state.training)


def _note(training: TrainingState) -> None:
    data = {
        "trialId": training.trial_id,
        "task": training.task,
        "mode": training.mode,
        "points": len(training.touches),
    }
    _log.info("The trial is %s.", training.phase.value, extra={"data": data})
