"""Signals in plain Python, their listeners, and calls whose errors stop nothing else."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

_logger = logging.getLogger("rastrainer.error_guard")

MAX_REMEMBERED = 100


class Signal:
    """Callables, called in the order of `listeners` with what `emit` is given."""

    def __init__(self) -> None:
        self.listeners: list[Callable[..., Any]] = []

    def connect(self, listener: Callable[..., Any]) -> None:
        self.listeners.append(listener)

    def disconnect(self, listener: Callable[..., Any]) -> None:
        if listener in self.listeners:
            self.listeners.remove(listener)

    def emit(self, *values: Any) -> None:
        for listener in tuple(self.listeners):
            listener(*values)


class Listening:
    """Listeners that are connected to their signals until this is closed."""

    def __init__(self, *pairs: tuple[Signal, Callable[..., Any]]) -> None:
        self._pairs: list[tuple[Signal, Callable[..., Any]]] = []
        self.listen(*pairs)

    def listen(self, *pairs: tuple[Signal, Callable[..., Any]]) -> None:
        self._pairs += pairs
        for signal, listener in pairs:
            signal.connect(listener)

    def close(self) -> None:
        for signal, listener in self._pairs:
            signal.disconnect(listener)


class ErrorGuard:
    """Runs one job after another; each different error is logged once."""

    def __init__(self) -> None:
        self._logged: set[tuple[str, str]] = set()

    def run(self, what: str, work: Callable[..., Any], *arguments: Any) -> Any | None:
        """Return what `work` returns, or None if it raises; `what` names it in the log."""
        try:
            return work(*arguments)
        except Exception as error:
            failure = (what, repr(error))
            if failure not in self._logged and len(self._logged) < MAX_REMEMBERED:
                self._logged.add(failure)
                _logger.exception("%s failed.", what)
            return None

    def emit(self, what: str, signal: Signal, *values: Any) -> None:
        for listener in tuple(signal.listeners):
            self.run(what, listener, *values)
