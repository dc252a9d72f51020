"""Collects what goes wrong inside slots: PythonQt prints an exception, and the click goes on."""

from __future__ import annotations

import sys
import traceback
from collections.abc import Callable

from rastrainer.errors import InputError


class Failures:
    """What would stand in Slicer's error log, and nobody would see.

    Attributes:
        texts: one traceback or sentence a failure.
        heard: is told each of them; None where nobody is.
    """

    def __init__(self) -> None:
        self.texts: list[str] = []
        self.heard: Callable[[str], None] | None = None
        self._told: list[BaseException] = []

    def add(self, text: str) -> None:
        """Remember a failure that is no exception."""
        self.texts.append(text)
        if self.heard is not None:
            self.heard(text)

    def tell(self, exception: BaseException | None) -> None:
        """Remember that the user was shown this exception."""
        if exception is not None:
            self._told.append(exception)

    def catch(self, exception: BaseException) -> None:
        """Take what a slot raised; what was told as a clear sentence is none."""
        isTold = any(exception is told for told in self._told)
        if not (isTold and isinstance(exception, InputError)):
            text = "".join(traceback.format_exception(exception))
            if text not in self.texts:  # A timer would repeat it ten times a second.
                self.add(text)
                print(text, file=sys.stderr)


FAILURES = Failures()
