"""What would have ended Slicer: a stand-in of its parts records it, where the real one aborts."""

from __future__ import annotations

import logging

_crashes: list[str] = []


class CrashError(RuntimeError):
    """Slicer would not have survived what happened."""


def recordCrash(sentence: str) -> CrashError:
    """Remember a crash, from any thread; the error may be raised where that is of use."""
    _crashes.append(sentence)
    logging.critical("Slicer would not have survived: %s", sentence)
    return CrashError(sentence)


def takeCrashes() -> list[str]:
    """Return what was recorded since the last call."""
    taken = _crashes[:]
    _crashes.clear()
    return taken
