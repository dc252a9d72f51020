"""`slicer.app.errorLogModel()`: what goes wrong is written into a file, as Slicer's log is."""

from __future__ import annotations

import logging
from datetime import datetime
from pathlib import Path

from Testing.slicer.host.checked import Checked
from Testing.slicer.host.failures import FAILURES


class ErrorLog(Checked):
    """Stands in for `ctkErrorLogModel`, of which the file alone is offered.

    Attributes:
        filePath: of the log.
    """

    measured = frozenset({"filePath", "logEntryCount", "logEntryDescription", "clear"})
    title = "slicer.app.errorLogModel()"

    def __init__(self, folder: Path) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.filePath = str(folder / "Slicer.log")
        self._handler = _Handler(self)
        logging.getLogger().addHandler(self._handler)
        self.write("INFO", "Unknown", "Slicer of the tests has started.")
        FAILURES.heard = lambda text: self.write("CRITICAL", "Stream", text)

    def write(self, level: str, origin: str, text: str) -> None:
        """Append an entry."""
        moment = datetime.now().strftime("%d.%m.%Y %H:%M:%S")
        with Path(self.filePath).open("a", encoding="utf-8") as file:
            file.write(f"[{level}][{origin}] {moment} [] (unknown:0) - {text}\n")

    def close(self) -> None:
        """Write no more."""
        FAILURES.heard = None
        logging.getLogger().removeHandler(self._handler)


class _Handler(logging.Handler):
    """Writes what Python logs."""

    def __init__(self, log: ErrorLog) -> None:
        super().__init__(logging.WARNING)
        self._log = log

    def emit(self, record: logging.LogRecord) -> None:
        self._log.write(record.levelname, "Python", record.getMessage())
