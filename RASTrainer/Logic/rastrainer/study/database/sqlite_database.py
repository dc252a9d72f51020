"""The SQLite file of a study: safe settings, transactions, errors as sentences.

The rollback journal is used, not the write-ahead log, which needs memory shared by all computers:
it would silently damage a study on a hospital's network drive. Writers wait for each other; a trial
takes milliseconds and comes once in minutes.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
from pathlib import Path
from urllib.parse import quote

from rastrainer.errors import InputError
from rastrainer.files.writing import keep_others_out, open_private
from rastrainer.study.database import schema
from rastrainer.study.database.database import LockWait, StudyBusyError, StudyDatabase

_COMMANDS = "SELECT count(*) FROM sqlite_master WHERE type NOT IN ('table', 'index')"
_BY_WORDS = {
    "not a database": "{0} is not a study database.",
    "readonly": "The study {0} is read-only; allow writing to it and its folder.",
    "unable to open": "The study {0} cannot be opened; check its permissions.",
    "full": "The study {0} cannot be written: the disk is full.",
    "disk i/o": "The study {0} cannot be read or written: the disk has errors.",
}
_PRAGMAS_OF_READERS = ("foreign_keys = ON", "trusted_schema = OFF")
_PRAGMAS = (
    *_PRAGMAS_OF_READERS,
    # Deleted trainees leave no bytes behind in the file.
    "secure_delete = ON",
    # Also sync the folder: committed changes survive a power failure, since the simulator forgets a
    # trial that we have acknowledged.
    "synchronous = EXTRA",
    "journal_mode = DELETE",
)
_DAMAGED = "The study {0} is damaged; restore it from a backup."


class SqliteDatabase(StudyDatabase):
    """A connection to one file; each process and thread may have one."""

    _connection: sqlite3.Connection
    _errors = sqlite3.Error

    def __init__(
        self,
        path: str | os.PathLike[str],
        lock_wait: LockWait | None = None,
        may_change: bool = True,
    ) -> None:
        """Open the file, or create it with its tables if it may be changed.

        In a file that may not be changed, an incomplete transaction left by a crash is rolled back
        first, as by any program that opens it; stored data remain.
        """
        self.path, self._may_change = Path(path), may_change
        if "\0" in str(self.path):
            raise InputError("The name of a study database must not contain a null character.")
        if self.path.is_dir():
            raise InputError(f"{self.path} is a folder; a study database is a file.")
        if not self.path.parent.is_dir():
            raise InputError(f"There is no folder {self.path.parent} for the study database.")
        if not may_change and not self.path.is_file():
            raise InputError(f"There is no file {self.path}.")
        super().__init__(self.path.stem, self.path, lock_wait)

    def version(self) -> int | None:
        try:
            self._connection.execute("PRAGMA busy_timeout = 0")
            return self._number("data_version")
        except sqlite3.Error:
            return None

    def continue_numbers(self) -> None:
        """Do nothing: SQLite numbers new rows after the last one."""

    def _begin(self, may_change: bool) -> None:
        timeout_ms = 1000 * self._lock_wait.timeout_s
        self._connection.execute(f"PRAGMA busy_timeout = {timeout_ms:.0f}")
        self._connection.execute("BEGIN IMMEDIATE" if may_change else "BEGIN")

    def _commit(self) -> None:
        self._connection.execute("COMMIT")

    def _roll_back(self) -> None:
        if self._connection.in_transaction:
            self._connection.execute("ROLLBACK")

    def _connect(self) -> sqlite3.Connection:
        if not self._may_change:
            journal = self.path.with_name(f"{self.path.name}-journal")
            if journal.is_file() and journal.stat().st_size > 0:
                with contextlib.closing(self._open(str(self.path))) as connection:
                    connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
            return self._open(read_only_uri(self.path))
        # Only a new file is opened: closing an existing one would release our other locks on it.
        with contextlib.suppress(OSError):
            os.close(open_private(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL))
        for suffix in ("", "-journal", "-wal", "-shm"):
            keep_others_out(f"{self.path}{suffix}")
        return self._open(str(self.path))

    def _open(self, name: str) -> sqlite3.Connection:
        timeout_s, is_uri = self._lock_wait.timeout_s, name.startswith("file://")
        # Transactions are explicit: `isolation_level=None`.
        return sqlite3.connect(name, timeout=timeout_s, isolation_level=None, uri=is_uri)

    def _prepare(self) -> None:
        for pragma in _PRAGMAS if self._may_change else _PRAGMAS_OF_READERS:
            self._connection.execute(f"PRAGMA {pragma}")
        # In one transaction: another process may be creating the tables.
        with self.reading():
            names = self._names()
            # Triggers and views in a foreign file could run as ours.
            if self._connection.execute(_COMMANDS).fetchone()[0]:
                raise InputError(
                    f"The study {self.path} contains triggers or views, which no study of "
                    "RASTrainer has."
                )
            if self._number("application_id") != (schema.APPLICATION_ID if names else 0):
                raise InputError(f"{self.path} is the database of another program.")
            if names:
                schema.check_schema_version(self._number("user_version"), self.path)
        if schema.missing_from(names):
            self._create_tables()
        is_whole = self._connection.execute("PRAGMA integrity_check(1)").fetchone() == ("ok",)
        if not is_whole or self._connection.execute("PRAGMA foreign_key_check").fetchone():
            raise sqlite3.DatabaseError("malformed")
        if not self._may_change:
            self._connection.execute("PRAGMA query_only = ON")

    def _create_tables(self) -> None:
        if not self._may_change:
            raise InputError(schema.lacking_sentence(self.path))
        with self.writing():
            # Another process may have been faster.
            for statement in schema.missing_from(self._names()):
                self._execute(statement)
            self._execute(f"PRAGMA user_version = {schema.SCHEMA_VERSION}")
            self._execute(f"PRAGMA application_id = {schema.APPLICATION_ID}")

    def _names(self) -> set[str]:
        return {name for (name,) in self._connection.execute("SELECT name FROM sqlite_master")}

    def _number(self, pragma: str) -> int:
        return self._connection.execute(f"PRAGMA {pragma}").fetchone()[0]

    def _explained(self, error: sqlite3.Error) -> InputError | None:
        if isinstance(
            error, (sqlite3.IntegrityError, sqlite3.ProgrammingError, sqlite3.InterfaceError)
        ):
            return None
        text = str(error).lower()
        if "locked" in text:
            return StudyBusyError(
                f"Another program has locked the study {self.path}; try again when it has finished."
            )
        sentence = next((said for words, said in _BY_WORDS.items() if words in text), _DAMAGED)
        return InputError(sentence.format(self.path))


def read_only_uri(path: Path) -> str:
    """Return the URI with which SQLite never writes to a file."""
    name = path.absolute().as_posix()
    # `C:/…` needs a slash before it; a share's `//server/…` must not become a host.
    rooted = name if name.startswith("/") else f"/{name}"
    return f"file://{quote(rooted)}?mode=ro"
