"""Errors in slots, which PythonQt prints, and in VTK, and Slicer's log of them."""

from __future__ import annotations

import logging
import sys
import traceback
from collections.abc import Callable
from datetime import datetime
from pathlib import Path
from typing import Any

import vtk

from Testing.slicer.host.members import Checked


class Failures:
    """What would be in Slicer's error log, unseen."""

    def __init__(self) -> None:
        self.texts: list[str] = []
        self.listener: Callable[[str], None] | None = None

    def add(self, text: str) -> None:
        """Remember a failure that is no exception."""
        self.texts.append(text)
        if self.listener is not None:
            self.listener(text)

    def catch(self, exception: BaseException) -> None:
        """Take what a slot raised: Slicer logs its traceback, also where a message was shown."""
        text = "".join(traceback.format_exception(exception))
        if text not in self.texts:  # A timer would repeat it ten times a second.
            self.add(text)
            print(text, file=sys.stderr)


FAILURES = Failures()


class ErrorLog(Checked):
    """Stands in for `ctkErrorLogModel`, of which the file alone is offered."""

    measured = frozenset({"filePath", "logEntryCount", "logEntryDescription", "clear"})
    title = "slicer.app.errorLogModel()"

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.filePath = str(folder / "Slicer.log")
        self._handler = _Handler(self)
        logging.getLogger().addHandler(self._handler)
        self.write("INFO", "Unknown", "Slicer of the tests has started.")
        FAILURES.listener = lambda text: self.write("CRITICAL", "Stream", text)

    def write(self, level: str, origin: str, text: str) -> None:
        moment = datetime.now().strftime("%d.%m.%Y %H:%M:%S")
        with Path(self.filePath).open("a", encoding="utf-8") as file:
            file.write(f"[{level}][{origin}] {moment} [] (unknown:0) - {text}\n")

    def close(self) -> None:
        FAILURES.listener = None
        logging.getLogger().removeHandler(self._handler)


class _Handler(logging.Handler):
    """Writes what Python logs."""

    def __init__(self, log: ErrorLog) -> None:
        super().__init__(logging.WARNING)
        self._log = log

    def emit(self, record: logging.LogRecord) -> None:
        self._log.write(record.levelname, "Python", record.getMessage())


_NO_SCREEN = "bad X server connection"
"""A computer of tests has no screen, which Slicer has."""
_EVENTS = ("ErrorEvent", "WarningEvent")


class VtkMessages:
    """Takes errors and warnings as failures, until `close`."""

    def __init__(self) -> None:
        self._window = vtk.vtkOutputWindow.GetInstance()
        self._tags = [self._window.AddObserver(event, _take) for event in _EVENTS]

    def close(self) -> None:
        for tag in self._tags:
            self._window.RemoveObserver(tag)


@vtk.calldata_type(vtk.VTK_STRING)
def _take(_window: Any, _event: str, text: str) -> None:
    if _NO_SCREEN not in text:
        FAILURES.add(text.strip())
