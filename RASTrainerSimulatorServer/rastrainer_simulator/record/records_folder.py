"""The folder of the trials' journals, which one simulator at a time writes to."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.journal.file_lock import lock

LOCK_NAME = ".simulator.lock"
_LONGEST_NUMBER = 20


class RecordsFolder:
    """Holds the folder until it is closed, or the process ends in whatever way."""

    def __init__(self, folder: Path) -> None:
        """Make the folder where it is missing, and take it.

        Raises:
            InputError: it cannot be made or written to, or another simulator has it.
        """
        self._folder = folder
        try:
            folder.mkdir(parents=True, exist_ok=True)
            flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0)
            self._descriptor = os.open(folder / LOCK_NAME, flags, 0o644)
        except OSError as error:
            raise InputError(
                f"Trials cannot be recorded in {folder}: {error.strerror}. Allow writing to it, "
                "or choose another folder with --records."
            ) from None
        try:
            self._take()
        except BaseException:
            os.close(self._descriptor)
            raise

    def close(self) -> None:
        """Leave the folder to others."""
        os.close(self._descriptor)

    def _take(self) -> None:
        try:
            lock(self._descriptor)
        except (BlockingIOError, PermissionError):
            raise InputError(
                f"Another simulator{self._holder()} records in {self._folder}: end it, or choose "
                "another folder with --records."
            ) from None
        except OSError as error:
            raise InputError(
                f"{self._folder} cannot be kept from being written by two simulators at once: "
                f"{error.strerror}. Choose a folder on a disk of this computer with --records."
            ) from None
        # Only for the sentence above: a full disk is told with the first trial.
        with contextlib.suppress(OSError):
            os.ftruncate(self._descriptor, 0)
            os.write(self._descriptor, str(os.getpid()).encode("ascii"))

    def _holder(self) -> str:
        with contextlib.suppress(OSError):
            number = os.read(self._descriptor, _LONGEST_NUMBER).decode("ascii", "ignore")
            if number.isdecimal():
                return f" (process {number})"
        return ""
