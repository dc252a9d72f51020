"""What the study's statements need of a database's connection, whichever database it is."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any, Protocol


class Rows(Protocol):
    """What a statement returns, row by row."""

    def fetchone(self) -> Any:
        """Return the next row as a tuple, or None."""

    def fetchall(self) -> list[Any]:
        """Return all further rows as tuples."""

    def __iter__(self) -> Iterator[Any]: ...


class Connection(Protocol):
    """A connection within a transaction; `sqlite3.Connection` is one.

    Statements are SQL that SQLite and PostgreSQL both know, with `?` for each parameter.
    `json_extract(column, '$.a.b')` is the one function that differs: its value may be a text.
    """

    def execute(self, sql: str, parameters: Sequence[Any] = ..., /) -> Rows:
        """Execute a statement."""

    def executemany(self, sql: str, parameters: Iterable[Sequence[Any]], /) -> object:
        """Execute a statement for each of several sequences of parameters."""
