"""The commands that wait for their answers."""

from __future__ import annotations

import itertools
from concurrent.futures import Future

from rastrainer_simulator.state import Answer


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
        """Answer everything that still waits with a refusal."""
        for ticket in tuple(self._futures):
            self.give(Answer(ticket, False, sentence))
