"""Turns of the main thread, during which workers pause.

Both share Python's lock: numpy and sqlite release it in the middle of the main thread's work, which
then waits for it each time. What would take the main thread 40 ms takes 150 then.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

LONGEST_S = 0.5
"""How long a worker pauses at most; a turn may last as long as a dialog is open."""


class _Turns:
    """Whose turn it is; changed by the main thread only."""

    def __init__(self) -> None:
        self.depth = 0
        self.isWorkers = threading.Event()
        self.isWorkers.set()


_TURNS = _Turns()


@contextmanager
def mainTurn() -> Iterator[None]:
    """Pause workers in a `with` statement of the main thread; may be nested."""
    _TURNS.depth += 1
    _TURNS.isWorkers.clear()
    try:
        yield
    finally:
        _TURNS.depth -= 1
        if _TURNS.depth == 0:
            _TURNS.isWorkers.set()


@contextmanager
def workersTurn() -> Iterator[None]:
    """Let workers run in a `with` statement of the main thread, even during its turn."""
    _TURNS.isWorkers.set()
    try:
        yield
    finally:
        if _TURNS.depth:
            _TURNS.isWorkers.clear()


def giveWay() -> None:
    """Wait in a worker until the main thread's turn is over, half a second at most."""
    _TURNS.isWorkers.wait(LONGEST_S)
