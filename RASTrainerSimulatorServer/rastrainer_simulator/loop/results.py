"""How results leave the control loop: once on disk, to callbacks and to waiting callers.

Clients and views belong to the event loop's thread: a feed hands the newest state over to it.
"""

from __future__ import annotations

import asyncio
import itertools
import logging
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import replace
from typing import Generic, Protocol, TypeVar

from rastrainer.journal.entries import PhaseChange
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.loop.timing import LoopStatistics
from rastrainer_simulator.record.trial_recorder import Written
from rastrainer_simulator.state import (
    Answer,
    Event,
    SimulationState,
    StepResult,
    TrainingState,
)

_log = logging.getLogger(__name__)


class DurableResults:
    """Holds back changes of the trial until they have been written.

    Poses are published immediately, with the trial as it last was on the disk.
    """

    def __init__(self, training: TrainingState) -> None:
        self.safe = training
        # In the order in which one thread writes them.
        self._unwritten: deque[tuple[Written, StepResult]] = deque()

    @property
    def is_waiting(self) -> bool:
        return any(written.is_awaited for written, _ in self._unwritten)

    def publishable(
        self, result: StepResult, written: Written | None
    ) -> tuple[StepResult, str | None]:
        """Return the result to publish now, and the reason if writing has failed."""
        if written is None and not self._unwritten:
            self.safe = result.state.training
            return result, None
        events: list[Event] = []
        answers: list[Answer] = []
        reason = None
        if written is not None:
            self._unwritten.append((written, result))
        while self._unwritten and self._unwritten[0][0].future.done():
            done, earlier = self._unwritten[0]
            error = done.future.exception()
            if error is not None:
                # The control loop undoes what has not been written.
                reason = str(error)
                sentence = f"This could not be recorded and does not count: {reason}."
                for each, undone in self._unwritten:
                    if each.is_awaited:
                        answers += [Answer(a.ticket, False, sentence) for a in undone.answers]
                self._unwritten.clear()
                break
            self._unwritten.popleft()
            if done.is_awaited:
                self.safe = earlier.state.training
                events += earlier.events
                answers += earlier.answers
        if written is None or not written.is_awaited:
            events += result.events
            answers += result.answers
        if not self.is_waiting and reason is None:
            self.safe = result.state.training
        state = replace(result.state, training=self.safe)
        return StepResult(state, tuple(events), tuple(answers)), reason


T = TypeVar("T")


class Subscribers(Generic[T]):
    """Callbacks for every published item; threads may add and remove them at any time."""

    def __init__(self) -> None:
        self._callbacks: tuple[Callable[[T], None], ...] = ()

    def add(self, callback: Callable[[T], None]) -> Callable[[], None]:
        """Call `callback` with every further item; return a function that unsubscribes."""
        self._callbacks = (*self._callbacks, callback)

        def remove() -> None:
            self._callbacks = tuple(one for one in self._callbacks if one is not callback)

        return remove

    def publish(self, item: T) -> None:
        for callback in self._callbacks:
            callback(item)


class StateSource(Protocol):
    """A control loop, a playback, or what switches between the two."""

    @property
    def latest(self) -> SimulationState: ...

    @property
    def setup(self) -> SimulationSetup: ...

    @property
    def statistics(self) -> LoopStatistics: ...

    @property
    def subscribe(self) -> Callable[[Callable[[StepResult], None]], Callable[[], None]]:
        """Calls a callback with each result, in any thread; returns what unsubscribes it."""


class StateFeed:
    """Subscriber of the control loop that delivers the newest state whenever one is due."""

    def __init__(
        self,
        is_due: Callable[[SimulationState], bool],
        deliver: Callable[[SimulationState], None],
        loop: asyncio.AbstractEventLoop,
    ):
        """`is_due` is called at every tick, in its thread; `deliver` in the thread of `loop`."""
        self._is_due = is_due
        self._deliver = deliver
        self._loop = loop
        self._newest: SimulationState | None = None
        self._is_scheduled = False

    def __call__(self, result: StepResult) -> None:
        self._newest = result.state
        if not self._is_scheduled and self._is_due(result.state):
            self._is_scheduled = True
            self._loop.call_soon_threadsafe(self._deliver_newest)

    def _deliver_newest(self) -> None:
        self._is_scheduled = False
        if self._newest is not None:
            self._deliver(self._newest)


def trial_log(loop: asyncio.AbstractEventLoop) -> Callable[[StepResult], None]:
    """Return a subscriber that logs the phases of trials, in the event loop's thread."""

    def note(training: TrainingState) -> None:
        data = {
            "trialId": training.trial_id,
            "task": training.task,
            "mode": training.mode,
            "points": len(training.touches),
        }
        _log.info("The trial is %s.", training.phase.value, extra={"data": data})

    def take(result: StepResult) -> None:
        if any(isinstance(event.entry, PhaseChange) for event in result.events):
            loop.call_soon_threadsafe(note, result.state.training)

    return take


class PendingAnswers:
    """Hands out tickets and resolves their futures; safe for several threads."""

    def __init__(self) -> None:
        self._tickets = itertools.count(1)
        self._futures: dict[int, Future[Answer]] = {}
        self._over = ""

    def expect(self) -> tuple[int, Future[Answer]]:
        future: Future[Answer] = Future()
        ticket = next(self._tickets)
        self._futures[ticket] = future
        if self._over:
            self.give(Answer(ticket, False, self._over))
        return ticket, future

    def give(self, answer: Answer) -> None:
        future = self._futures.pop(answer.ticket, None)
        if future is not None and future.set_running_or_notify_cancel():
            future.set_result(answer)

    def refuse_all(self, sentence: str) -> None:
        """Refuse what waits for an answer, and all that follows."""
        self._over = sentence
        for ticket in tuple(self._futures):
            self.give(Answer(ticket, False, sentence))
