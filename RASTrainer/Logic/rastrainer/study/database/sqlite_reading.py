"""Open a study's file for reading only, without changing it."""

from __future__ import annotations

import sqlite3
from pathlib import Path
from urllib.parse import quote

from rastrainer.errors import InputError
from rastrainer.study.database.schema import MIGRATIONS
from rastrainer.study.database.sqlite_database import SqliteDatabase


class ReadOnlySqliteDatabase(SqliteDatabase):
    """A connection that cannot change the file.

    A study of an earlier format is migrated in memory. An incomplete transaction left by a crash is
    rolled back first, as by any program that opens the file; stored data remain.
    """

    def _connect(self) -> sqlite3.Connection:
        if not self.path.is_file():
            raise InputError(f"There is no file {self.path}.")
        if _holds_something(self.path.with_name(f"{self.path.name}-journal")):
            self._roll_back()
        return sqlite3.connect(
            read_only_uri(self.path),
            timeout=self._lock_wait.timeout_s,
            isolation_level=None,
            uri=True,
        )

    def _prepare(self) -> None:
        self._guard()
        with self.reading():
            self._check_origin()
            is_old = self._number("user_version") < len(MIGRATIONS)
        if is_old:
            self._copy_into_memory()
            self._migrate()
        self._check_whole()
        self._connection.execute("PRAGMA query_only = ON")

    def _roll_back(self) -> None:
        connection = sqlite3.connect(self.path, timeout=self._lock_wait.timeout_s)
        try:
            connection.execute("SELECT count(*) FROM sqlite_master").fetchone()
        finally:
            connection.close()

    def _guard(self) -> None:
        for pragma in ("foreign_keys = ON", "trusted_schema = OFF"):
            self._connection.execute(f"PRAGMA {pragma}")

    def _copy_into_memory(self) -> None:
        file, self._connection = self._connection, sqlite3.connect(":memory:", isolation_level=None)
        try:
            file.backup(self._connection)
        finally:
            file.close()
        self._guard()


def read_only_uri(path: Path) -> str:
    """Return the URI with which SQLite never writes to a file."""
    name = path.absolute().as_posix()
    # `C:/…` needs a slash before it; a share's `//server/…` must not become a host.
    rooted = name if name.startswith("/") else f"/{name}"
    return f"file://{quote(rooted)}?mode=ro"


def _holds_something(path: Path) -> bool:
    try:
        return path.stat().st_size > 0
    except OSError:
        return False
