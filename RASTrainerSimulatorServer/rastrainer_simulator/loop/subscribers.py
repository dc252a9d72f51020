"""How results leave the control loop: callbacks for what is published, futures of answers."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from concurrent.futures import Future
from typing import Generic, TypeVar

from rastrainer_simulator.state import Answer

T = TypeVar("T")


class Subscribers(Generic[T]):
    """Callbacks that are called with every published item, in the publishing thread.

    They may be added and removed at any time, also from other threads.
    """

    def __init__(self) -> None:
        self._callbacks: tuple[Callable[[T], None], ...] = ()

    def add(self, callback: Callable[[T], None]) -> Callable[[], None]:
        """Call `callback` with every further item; return a function that unsubscribes."""
        self._callbacks = (*self._callbacks, callback)

        def remove() -> None:
            self._callbacks = tuple(one for one in self._callbacks if one is not callback)

        return remove

    def publish(self, item: T) -> None:
        """Call every callback."""
        for callback in self._callbacks:
            callback(item)


class PendingAnswers:
    """Hands out tickets and resolves their futures; safe for several threads."""

    def __init__(self) -> None:
        self._tickets = itertools.count(1)
        self._futures: dict[int, Future[Answer]] = {}

    def expect(self) -> tuple[int, Future[Answer]]:
        """Return a new ticket and the future of its answer."""
        future: Future[Answer] = Future()
        ticket = next(self._tickets)
        self._futures[ticket] = future
        return ticket, future

    def give(self, answer: Answer) -> None:
        """Resolve the future of an answer's ticket; a second answer is ignored."""
        future = self._futures.pop(answer.ticket, None)
        if future is not None and future.set_running_or_notify_cancel():
            future.set_result(answer)

    def refuse_all(self, sentence: str) -> None:
        """Refuse everything that still waits for an answer."""
        for ticket in tuple(self._futures):
            self.give(Answer(ticket, False, sentence))
