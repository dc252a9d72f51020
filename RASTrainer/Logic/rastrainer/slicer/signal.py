"""Tells listeners that something happened, in plain Python: Qt's signals are not needed for it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any


class Signal:
    """A list of callables; each is called with what `emit` is given."""

    def __init__(self) -> None:
        self._listeners: list[Callable[..., Any]] = []

    def connect(self, listener: Callable[..., Any]) -> None:
        """Call `listener` from now on."""
        self._listeners.append(listener)

    def disconnect(self, listener: Callable[..., Any]) -> None:
        """Call `listener` no more; one that is not connected is no error."""
        if listener in self._listeners:
            self._listeners.remove(listener)

    @property
    def listeners(self) -> tuple[Callable[..., Any], ...]:
        """Who is told, in this order."""
        return tuple(self._listeners)

    def emit(self, *values: Any) -> None:
        """Call every listener."""
        for listener in self.listeners:
            listener(*values)
