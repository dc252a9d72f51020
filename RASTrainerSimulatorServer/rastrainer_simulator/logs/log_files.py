"""Logs go to files that rotate; warnings go to the terminal, too.

No secret and no pseudonym is ever logged: pairing codes and keys are printed or passed by the
environment, and a trial is named by its UUID, so that a deleted trainee leaves no trace here.
"""

from __future__ import annotations

import contextlib
import logging
import logging.handlers
import os
from collections.abc import Iterator
from pathlib import Path
from typing import TextIO

from rastrainer.errors import RASTrainerError
from rastrainer.journal.file_lock import lock
from rastrainer.private_files import make_private_folder, open_private
from rastrainer_simulator.logs.aside import Aside
from rastrainer_simulator.logs.json_lines import JsonLines

LARGEST_FILE = 1_000_000
OLDER_FILES = 5
MOST_LOGS = 9
"""Of one name that are written to at the same time."""
TERMINAL_FORMAT = "%(asctime)s %(levelname)s %(name)s: %(message)s"

_OURS = ("rastrainer", "rastrainer_simulator")

_log = logging.getLogger(__name__)
_crashes = logging.getLogger("rastrainer.crash")


class _LogFile(logging.handlers.RotatingFileHandler):
    """A file that gives up silently: a full disk is told where the trial is recorded."""

    def _open(self) -> TextIO:
        """Open the file for its user alone; an older one is this one, renamed."""
        descriptor = open_private(self.baseFilename, os.O_WRONLY | os.O_CREAT | os.O_APPEND)
        return os.fdopen(descriptor, self.mode, encoding=self.encoding, errors=self.errors)

    def handleError(self, _record: logging.LogRecord) -> None:  # noqa: N802 - logging's own name
        """Do nothing."""


@contextlib.contextmanager
def keep_logs(folder: Path, name: str) -> Iterator[None]:
    """Log to `NAME.log` in a folder, and warnings to the terminal.

    Where another program logs to that file it is `NAME-2.log`, and so on: two that rotate one file
    would lose each other's lines. A folder that cannot be written to is told in one warning:
    nothing depends on a log.
    """
    terminal = logging.StreamHandler()
    terminal.setLevel(logging.WARNING)
    terminal.setFormatter(logging.Formatter(TERMINAL_FORMAT))
    with contextlib.ExitStack() as ends:
        _add(ends, logging.getLogger(), Aside(terminal))
        opened = _opened(ends, folder, name)
        if opened is not None:
            file = Aside(opened)
            _add(ends, logging.getLogger(), file)
            _add(ends, _crashes, file)
            _crashes.propagate = False
            for package in _OURS:
                logging.getLogger(package).setLevel(logging.INFO)
        with _crashes_logged():
            yield


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
    """Return the first name that no other program logs by, and hold it."""
    for own in (name, *(f"{name}-{number}" for number in range(2, MOST_LOGS + 1))):
        flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0)
        descriptor = open_private(folder / f".{own}.lock", flags)
        ends.callback(os.close, descriptor)
        with contextlib.suppress(OSError):
            lock(descriptor)
            return own
    # Locks are not to be had here, as on some disks of other computers.
    return name


def _add(ends: contextlib.ExitStack, logger: logging.Logger, handler: logging.Handler) -> None:
    logger.addHandler(handler)
    ends.callback(handler.close)
    ends.callback(logger.removeHandler, handler)


@contextlib.contextmanager
def _crashes_logged() -> Iterator[None]:
    """Log why the program ends; the terminal is told by whoever catches it."""
    try:
        yield
    except RASTrainerError as error:
        _crashes.error("%s", error)
        raise
    except Exception:
        _crashes.critical("The program has crashed.", exc_info=True)
        raise
