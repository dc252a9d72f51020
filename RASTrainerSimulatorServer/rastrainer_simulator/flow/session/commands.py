"""The trainee's commands to the simulation, and their answers, without waiting."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import Any

from rastrainer.command_arguments import check_arguments
from rastrainer_simulator.state import Answer

Submit = Callable[[str, Mapping[str, Any], str], "Future[Answer]"]


class Commands:
    """Submits commands, and reports those that were refused once the answer has come."""

    def __init__(self, submit: Submit, refused: Callable[[str, str], None]) -> None:
        """Prepare; `refused` is called with a command's name and the sentence that refuses it."""
        self._submit = submit
        self._refused = refused
        self._waiting: list[tuple[str, Future[Answer]]] = []

    def do(self, name: str, sender: str, arguments: Mapping[str, Any]) -> None:
        """Have a command carried out.

        Raises:
            InputError: an argument is wrong.
        """
        future = self._submit(name, check_arguments(name, arguments), sender)
        self._waiting.append((name, future))

    def poll(self) -> None:
        """Look at the answers that have come."""
        asked, self._waiting = self._waiting, []
        for name, future in asked:
            if not future.done():
                self._waiting.append((name, future))
            elif not future.result().ok:
                self._refused(name, future.result().message)
