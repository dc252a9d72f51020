"""Calls something in the next turn of Qt's event loop."""

from __future__ import annotations

from collections.abc import Callable

import qt


def callSoon(work: Callable[[], None]) -> None:
    """Call `work` as soon as what is being done now is over."""
    qt.QTimer.singleShot(0, work)
