"""Write a trial's journal, in a folder that one simulator at a time writes to.

A journal is append-only, chained by hashes, and synced before its trial is published. The format is
described in `docs/trial-journal.md`.
"""

from __future__ import annotations

import contextlib
import logging
import os
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError, RASTrainerError
from rastrainer.files.writing import keep_others_out, make_private_folder, open_private
from rastrainer.journal.entries import Entry, Line, Stamp
from rastrainer.journal.folder import (
    LOCK_NAME,
    STARTED_BY,
    FolderHolder,
    journal_names,
    lock,
    open_lock_file,
    read_open_holder,
    write_holder,
)
from rastrainer.journal.journal_file import (
    NO_LINE,
    SEED_SUFFIX,
    Integrity,
    JournalReading,
    encode_line,
    read_journal,
)

_log = logging.getLogger(__name__)


class RecordError(RASTrainerError):
    """The journal could not be written; the message is shown to the trainee."""


class Journal:
    """One trial's journal file.

    Entries that could not be written are kept, and written in order with later entries: nothing is
    lost while the program runs, and the chain has no gap. Not safe for several threads.
    """

    def __init__(self, path: Path, seed: int | None = None) -> None:
        """Prepare a new file, which the first `write` creates and never overwrites.

        A file next to it keeps the seed of the head's pose until an entry reveals the seed.
        """
        self.path = path
        self._seed = seed
        self._seed_path = path.with_suffix(SEED_SUFFIX)
        self._descriptor: int | None = None
        self._count = 0
        self.last_hash = NO_LINE
        self._size: int | None = None
        self._is_new = True
        self._unwritten: list[Mapping[str, Any]] = []
        self._has_failed = False

    @classmethod
    def reopened(cls, reading: JournalReading) -> Journal:
        """Return the journal of an existing file that was not altered, to append to it.

        The first `write` removes an incomplete last line, which was never acknowledged.
        """
        journal = cls(reading.path)
        journal._is_new = False
        journal._append_to(reading)
        return journal

    def write(self, entries: Sequence[Mapping[str, Any]], sync: bool) -> None:
        """Append entries; with `sync` they are on the disk when this returns.

        Those that cannot be written raise RecordError, and are kept for the next `write`.
        """
        self._unwritten.extend(entries)
        try:
            descriptor, size = self._opened()
            count, last_hash, lines = self._count, self.last_hash, []
            for entry in self._unwritten:
                count += 1
                line, last_hash = encode_line(count, last_hash, entry)
                lines.append(line)
            data = b"".join(lines)
            os.lseek(descriptor, size, os.SEEK_SET)
            rest = memoryview(data)
            while rest:
                rest = rest[os.write(descriptor, rest) :]
            is_revealed = any("seed" in entry for entry in self._unwritten)
            if sync or is_revealed:
                os.fsync(descriptor)
            if is_revealed:
                self._seed_path.unlink(missing_ok=True)
        except OSError as error:
            if self._descriptor is not None and self._size is not None:
                # Leave no partial line behind; if even that fails, the next `write` does it.
                with contextlib.suppress(OSError):
                    os.ftruncate(self._descriptor, self._size)
            self.close()
            reason = f"{self.path.name}: {error.strerror or error}"
            if not self._has_failed:
                _log.error("Nothing is recorded: %s", reason)
            self._has_failed = True
            raise RecordError(reason) from error
        self._count, self.last_hash, self._size = count, last_hash, size + len(data)
        self._has_failed = False
        self._unwritten.clear()

    def write_lines(self, lines: Iterable[Line], sync: bool) -> None:
        self.write([line.to_json() for line in lines], sync)

    def append(self, at: Stamp, entry: Entry) -> None:
        try:
            self.write_lines([Line(at, entry)], sync=True)
        finally:
            self.close()

    def close(self) -> None:
        """Close the file; a later `write` opens it again."""
        if self._descriptor is not None:
            os.close(self._descriptor)
            self._descriptor = None

    def forget_unwritten(self) -> None:
        self._unwritten.clear()

    def discard(self) -> None:
        """Remove a new file, in which nothing was acknowledged, and forget its entries."""
        self.close()
        self.forget_unwritten()
        if self._is_new and self._size is not None:
            self.path.unlink(missing_ok=True)
            self._seed_path.unlink(missing_ok=True)
            self._size = None

    def _opened(self) -> tuple[int, int]:
        if self._descriptor is not None and self._size is not None:
            return self._descriptor, self._size
        flags = os.O_RDWR | getattr(os, "O_BINARY", 0) | getattr(os, "O_CLOEXEC", 0)
        if self._size is None:
            make_private_folder(self.path.parent)
            if self._seed is not None:
                seed = open_private(self._seed_path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
                try:
                    os.write(seed, str(self._seed).encode("ascii"))
                    os.fsync(seed)
                finally:
                    os.close(seed)
            self._descriptor = descriptor = open_private(self.path, flags | os.O_CREAT | os.O_EXCL)
            self._size = 0
            if os.name == "posix":
                # Make the new file's name durable; Windows does it automatically.
                folder = os.open(self.path.parent, os.O_RDONLY)
                try:
                    os.fsync(folder)
                finally:
                    os.close(folder)
        else:
            self._descriptor = descriptor = open_private(self.path, flags)
        lock(descriptor)
        if os.fstat(descriptor).st_size != self._size:
            # Another process has written.
            reading = read_journal(self.path)
            if reading.integrity is Integrity.ALTERED:
                raise RecordError(
                    f"{self.path.name} is {reading.sentence}; nothing is added to it."
                )
            os.ftruncate(descriptor, self._append_to(reading))
        return descriptor, self._size

    def _append_to(self, reading: JournalReading) -> int:
        self._count = len(reading.entries)
        self.last_hash = reading.entries[-1]["sha256"] if reading.entries else NO_LINE
        self._size = reading.end
        return reading.end


PEEK_S = 0.5
"""How long another program may hold the lock to see which simulator has the folder."""
_PERIOD_S = 0.02


class RecordsFolder:
    """Locks the folder until it is closed or the process ends."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._holder = FolderHolder(
            os.getpid(),
            datetime.now(timezone.utc).isoformat(timespec="milliseconds"),
            os.environ.get(STARTED_BY, ""),
        )
        # Users who have started the simulator themselves can choose.
        chosen = not self._holder.started_by
        elsewhere = ", or choose another folder with --records" if chosen else ""
        try:
            make_private_folder(folder)
            self._descriptor = open_lock_file(folder / LOCK_NAME)
        except OSError as error:
            raise InputError(
                f"Trials cannot be recorded in {folder}: {error.strerror}. Allow writing to it"
                f"{elsewhere}."
            ) from None
        try:
            self._lock(elsewhere)
            self.announce("", 0, "")
            for journal in journal_names(folder):
                keep_others_out(journal)
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
        os.close(self._descriptor)

    def _lock(self, elsewhere: str) -> None:
        end = time.monotonic() + PEEK_S
        while True:
            try:
                return lock(self._descriptor)
            except (BlockingIOError, PermissionError):
                if time.monotonic() > end:
                    pid = read_open_holder(self._descriptor).pid
                    who = f" (process {pid})" if pid else ""
                    raise InputError(
                        f"Another simulator{who} records in {self._folder}: end it{elsewhere}."
                    ) from None
            except OSError as error:
                raise InputError(
                    f"{self._folder} cannot be locked against a second simulator: "
                    f"{error.strerror}. Use a folder on a disk of this computer{elsewhere}."
                ) from None
            time.sleep(_PERIOD_S)
