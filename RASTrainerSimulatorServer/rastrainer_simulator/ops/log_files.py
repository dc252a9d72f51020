"""Logs go to files that rotate; warnings go to the terminal, too.

No secret and no pseudonym is ever logged: pairing codes and keys are printed or passed by the
environment, and a trial is named by its UUID, so that a deleted trainee leaves no trace here.
"""

from __future__ import annotations

import contextlib
import json
import logging
import logging.handlers
import os
import queue
import threading
from collections.abc import Iterator
from datetime import datetime, timezone
from io import TextIOWrapper
from pathlib import Path

from rastrainer.errors import RASTrainerError
from rastrainer.files.writing import make_private_folder, open_private
from rastrainer.journal.entries import iso
from rastrainer.journal.folder import lock, open_lock_file

LARGEST_FILE = 1_000_000
OLDER_FILES = 5
MAX_LOGS = 9
"""Most logs of one name that are written at a time."""
TERMINAL_FORMAT = "%(asctime)s %(levelname)s %(name)s: %(message)s"

_OURS = ("rastrainer", "rastrainer_simulator")

_log = logging.getLogger(__name__)
_crashes = logging.getLogger("rastrainer.crash")
LONGEST_MESSAGE = 8000
"""Most characters of a message or a traceback; the rest is cut."""
MAX_WAITING = 1000
CLOSE_TIMEOUT_S = 1.0


class _LogFile(logging.handlers.RotatingFileHandler):
    """A file that ignores errors: a full disk is reported where the trial is recorded."""

    def _open(self) -> TextIOWrapper:
        descriptor = open_private(self.baseFilename, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        return os.fdopen(descriptor, "a", encoding=self.encoding, errors=self.errors)

    def handleError(self, _record: logging.LogRecord) -> None:  # noqa: N802 - logging's own name
        """Do nothing."""


@contextlib.contextmanager
def keep_logs(folder: Path, name: str) -> Iterator[None]:
    """Log to `NAME.log` in a folder, and warnings to the terminal.

    If another program logs to that file it is `NAME-2.log`, and so on: two programs that rotate one
    file would lose each other's lines. A folder that cannot be written to only causes a warning.
    """
    terminal = logging.StreamHandler()
    terminal.setLevel(logging.WARNING)
    terminal.setFormatter(logging.Formatter(TERMINAL_FORMAT))
    with contextlib.ExitStack() as ends:
        _add(ends, logging.getLogger(), BackgroundHandler(terminal))
        opened = _opened(ends, folder, name)
        if opened is not None:
            file = BackgroundHandler(opened)
            _add(ends, logging.getLogger(), file)
            _add(ends, _crashes, file)
            _crashes.propagate = False
            for package in _OURS:
                logging.getLogger(package).setLevel(logging.INFO)
        try:
            yield
        except RASTrainerError as error:
            # The caller prints it.
            _crashes.error("%s", error)
            raise
        except Exception:
            _crashes.critical("The program has crashed.", exc_info=True)
            raise


def _opened(ends: contextlib.ExitStack, folder: Path, name: str) -> _LogFile | None:
    try:
        make_private_folder(folder)
        file = _LogFile(
            folder / f"{_free_name(ends, folder, name)}.log",
            maxBytes=LARGEST_FILE,
            backupCount=OLDER_FILES,
            encoding="utf-8",
        )
    except OSError as error:
        _log.warning("There is no log: %s cannot be written to (%s).", folder, error.strerror)
        return None
    file.setFormatter(JsonLines())
    return file


def _free_name(ends: contextlib.ExitStack, folder: Path, name: str) -> str:
    """Lock and return the first name that no other program logs to."""
    for own in (name, *(f"{name}-{number}" for number in range(2, MAX_LOGS + 1))):
        descriptor = open_lock_file(folder / f".{own}.lock")
        ends.callback(os.close, descriptor)
        with contextlib.suppress(OSError):
            lock(descriptor)
            return own
    # Locks are not available here, as on some network disks.
    return name


def _add(ends: contextlib.ExitStack, logger: logging.Logger, handler: logging.Handler) -> None:
    logger.addHandler(handler)
    ends.callback(handler.close)
    ends.callback(logger.removeHandler, handler)


class JsonLines(logging.Formatter):
    """Formats a record as `{"utc": …, "level": …, "logger": …, "message": …}`.

    `extra={"data": {…}}` is put under `data`, a traceback under `traceback`.
    """

    def format(self, record: logging.LogRecord) -> str:
        """Return the line, without a newline."""
        line = {
            "utc": iso(datetime.fromtimestamp(record.created, timezone.utc)),
            "level": record.levelname.lower(),
            "logger": record.name,
            "process": record.process,
            "message": record.getMessage()[:LONGEST_MESSAGE],
        }
        data = getattr(record, "data", None)
        if data is not None:
            line["data"] = data
        if record.exc_info:
            line["traceback"] = self.formatException(record.exc_info)[-LONGEST_MESSAGE:]
        return json.dumps(line, default=str)


class BackgroundHandler(logging.Handler):
    """Passes records to another handler in a separate thread, in order.

    A pipe whose reader has stopped, a terminal in which text is being selected and a disk that is
    asleep all make a write wait, and a waiting server answers no one. Records that the other
    handler cannot take in time are lost; a line in their place says how many. The standard
    library's QueueHandler and QueueListener neither count lost records nor give up when the program
    ends, and they drop tracebacks.
    """

    def __init__(self, handler: logging.Handler) -> None:
        """`handler` belongs to it from now on; its level counts."""
        super().__init__(handler.level)
        self._handler = handler
        self._waiting: queue.Queue[logging.LogRecord | None] = queue.Queue(MAX_WAITING)
        self._lost = 0
        self._thread = threading.Thread(target=self._write, name="log", daemon=True)
        self._thread.start()

    def emit(self, record: logging.LogRecord) -> None:
        try:
            if self._lost:
                self._waiting.put_nowait(_gap(self._lost))
                self._lost = 0
            self._waiting.put_nowait(record)
        except queue.Full:
            self._lost += 1

    def close(self) -> None:
        """Write what waits, for at most a second."""
        with contextlib.suppress(queue.Full):
            if self._lost:
                self._waiting.put(_gap(self._lost), timeout=CLOSE_TIMEOUT_S)
            self._waiting.put(None, timeout=CLOSE_TIMEOUT_S)
        self._thread.join(CLOSE_TIMEOUT_S)
        if not self._thread.is_alive():
            self._handler.close()
        super().close()

    def _write(self) -> None:
        while (record := self._waiting.get()) is not None:
            self._handler.handle(record)


def _gap(lost: int) -> logging.LogRecord:
    words = "%d lines are missing here: they could not be written in time."
    return logging.LogRecord(__name__, logging.WARNING, __file__, 0, words, (lost,), None)
