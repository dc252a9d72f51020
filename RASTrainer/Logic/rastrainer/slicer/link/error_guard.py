"""Contains errors, so that what fails does not stop the rest."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any

from rastrainer.slicer.signal import Signal

_logger = logging.getLogger("rastrainer.error_guard")

MOST_REMEMBERED = 100


class ErrorGuard:
    """Runs one piece of work after another; each different error is logged once."""

    def __init__(self) -> None:
        self._logged: set[tuple[str, str]] = set()

    def run(self, what: str, work: Callable[..., Any], *arguments: Any) -> Any | None:
        """Return what `work` returns, None where it raises; `what` names it in the log."""
        try:
            return work(*arguments)
        except Exception as error:
            failure = (what, repr(error))
            if failure not in self._logged and len(self._logged) < MOST_REMEMBERED:
                self._logged.add(failure)
                _logger.exception("%s failed.", what)
            return None

    def emit(self, what: str, signal: Signal, *values: Any) -> None:
        """Call every listener of a signal, whichever of them fail."""
        for listener in signal.listeners:
            self.run(what, listener, *values)
