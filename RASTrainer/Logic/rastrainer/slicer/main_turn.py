"""Turns of the main thread, in which a worker that asks stands aside.

Both would share Python's lock: numpy and sqlite give it away in the midst of what the main thread
does, and each time it has to be waited for. What would take the main thread 40 ms takes 150 then.
"""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

LONGEST_S = 0.5
"""So long a worker stands aside; a turn may last as long as a dialog is open."""


class _Turns:
    """Whose turn it is; only the main thread changes that."""

    def __init__(self) -> None:
        self.depth = 0
        self.isWorkers = threading.Event()
        self.isWorkers.set()


_TURNS = _Turns()


@contextmanager
def mainTurn() -> Iterator[None]:
    """Have workers stand aside in a `with` statement of the main thread; they may be nested."""
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
    """Let workers go on in a `with` statement of the main thread, in the midst of its turn, too."""
    _TURNS.isWorkers.set()
    try:
        yield
    finally:
        if _TURNS.depth:
            _TURNS.isWorkers.clear()


def giveWay() -> None:
    """Wait in a worker until it is no turn of the main thread's, for half a second at most."""
    _TURNS.isWorkers.wait(LONGEST_S)
