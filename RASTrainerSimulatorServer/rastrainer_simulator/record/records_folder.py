"""The folder of the trials' journals, which one simulator at a time writes to."""

from __future__ import annotations

import contextlib
import os
import time
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.files.writing import keep_others_out, make_private_folder, open_private
from rastrainer.journal.folder import (
    LOCK_NAME,
    STARTED_BY,
    SUFFIX,
    FolderHolder,
    lock,
    read_open_holder,
    write_holder,
)

PEEK_S = 0.5
"""How long another program may hold the lock to see which simulator has the folder."""
_PERIOD_S = 0.02


class RecordsFolder:
    """Locks the folder until it is closed or the process ends."""

    def __init__(self, folder: Path) -> None:
        """Create the folder if it is missing, and lock it.

        Raises:
            InputError: it cannot be made or written to, or another simulator has it.
        """
        self._folder = folder
        self._holder = FolderHolder(
            os.getpid(),
            datetime.now(timezone.utc).isoformat(timespec="milliseconds"),
            os.environ.get(STARTED_BY, ""),
        )
        try:
            make_private_folder(folder)
            flags = os.O_RDWR | os.O_CREAT | getattr(os, "O_CLOEXEC", 0)
            self._descriptor = open_private(folder / LOCK_NAME, flags)
        except OSError as error:
            raise InputError(
                f"Trials cannot be recorded in {folder}: {error.strerror}. Allow writing to it"
                f"{self._or_elsewhere}."
            ) from None
        try:
            self._take()
        except BaseException:
            os.close(self._descriptor)
            raise

    def announce(self, host: str, port: int, page: str) -> None:
        """Write to the folder where its simulator can be reached; see `FolderHolder`."""
        self._holder = replace(self._holder, host=host, port=port, page=page)
        # This only helps others: a full disk is reported with the first trial.
        with contextlib.suppress(OSError):
            write_holder(self._descriptor, self._holder)

    def close(self) -> None:
        """Leave the folder to others."""
        os.close(self._descriptor)

    @property
    def _or_elsewhere(self) -> str:
        """What users who have started the simulator themselves can do instead."""
        if self._holder.started_by:
            return ""
        return ", or choose another folder with --records"

    def _take(self) -> None:
        try:
            self._lock()
        except (BlockingIOError, PermissionError):
            pid = read_open_holder(self._descriptor).pid
            who = f" (process {pid})" if pid else ""
            raise InputError(
                f"Another simulator{who} records in {self._folder}: end it{self._or_elsewhere}."
            ) from None
        except OSError as error:
            raise InputError(
                f"{self._folder} cannot be locked against a second simulator: {error.strerror}. "
                f"Use a folder on a disk of this computer{self._or_elsewhere}."
            ) from None
        self.announce("", 0, "")
        for journal in self._folder.glob(f"*{SUFFIX}"):
            keep_others_out(journal)

    def _lock(self) -> None:
        """Lock the folder, waiting for programs that only check its lock."""
        end = time.monotonic() + PEEK_S
        while True:
            try:
                return lock(self._descriptor)
            except (BlockingIOError, PermissionError):
                if time.monotonic() > end:
                    raise
            time.sleep(_PERIOD_S)
