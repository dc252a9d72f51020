"""The trainee's commands to the simulation, and their answers, without waiting."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import Any

from rastrainer.protocol import check_arguments
from rastrainer_simulator.state import Answer

Submit = Callable[[str, Mapping[str, Any], str], "Future[Answer]"]
Then = Callable[[Answer], None]


class Commands:
    """Submits commands and hands each answer on when it has come."""

    def __init__(self, submit: Submit, refused: Callable[[str, str], None]) -> None:
        """Prepare; `refused` is told a command's name and the sentence that refuses it."""
        self._submit = submit
        self._refused = refused
        self._waiting: list[tuple[str, Future[Answer], Then | None]] = []

    def do(
        self, name: str, sender: str, arguments: Mapping[str, Any], then: Then | None = None
    ) -> None:
        """Have a command carried out; `then` is called with the answer if it was.

        Raises:
            InputError: an argument is wrong.
        """
        future = self._submit(name, check_arguments(name, arguments), sender)
        self._waiting.append((name, future, then))

    def poll(self) -> None:
        """Hand on the answers that have come."""
        answered = [each for each in self._waiting if each[1].done()]
        self._waiting = [each for each in self._waiting if not each[1].done()]
        for name, future, then in answered:
            answer = future.result()
            if not answer.ok:
                self._refused(name, answer.message)
            elif then is not None:
                then(answer)
