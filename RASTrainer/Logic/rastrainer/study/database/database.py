"""A study's database, whichever it is: transactions, and how long they wait for others."""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from typing import Any, Protocol

from rastrainer.errors import InputError
from rastrainer.study.database.address import StudyPlace

BUSY_TIMEOUT_S = 30.0
INTERACTIVE_TIMEOUT_S = 0.05
"""Not noticeable in a window."""
REST_S = 1.0


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


class LockWait:
    """How long to wait for a lock; after a timeout, not at all for a while.

    A panel queries a study ten times in a row: if another program holds a lock, it waits once, not
    ten times. Several connections may share one.
    """

    def __init__(
        self,
        most_s: float = BUSY_TIMEOUT_S,
        rest_s: float = 0.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        """Wait `most_s` for a lock, but not within `rest_s` after a timeout."""
        self._most_s, self._rest_s, self._clock = most_s, rest_s, clock
        self._retry_at = float("-inf")
        self._has_timed_out = False

    @classmethod
    def interactive(cls) -> LockWait:
        """Return the waiting times of a GUI thread."""
        return cls(INTERACTIVE_TIMEOUT_S, REST_S)

    @property
    def timeout_s(self) -> float:
        """How long to wait now."""
        return 0.0 if self._clock() < self._retry_at else self._most_s

    def note_timeout(self, waited_s: float = 0.0) -> None:
        """Note a timeout; after a long wait, the rest lasts ten times as long."""
        self._has_timed_out = True
        if self._clock() >= self._retry_at and self._rest_s:
            self._retry_at = self._clock() + max(self._rest_s, 10.0 * waited_s)

    def may_retry(self) -> bool:
        """Return once whether it is time to retry after a timeout."""
        is_time = self._has_timed_out and self._clock() >= self._retry_at
        self._has_timed_out = self._has_timed_out and not is_time
        return is_time


class StudyBusyError(InputError):
    """Another program has locked the study; nothing has changed, try again."""


class StudyAwayError(StudyBusyError):
    """The study's server cannot be reached; try again.

    Where the connection was lost while a change was being stored, it may or may not be stored.
    """


class StudyDatabase(ABC):
    """A connection to a study; each process and thread may have one.

    Attributes:
        name: of the study, for reports.
        place: where it is.
    """

    _connection: Any

    def __init__(self, name: str, place: StudyPlace, lock_wait: LockWait | None) -> None:
        """Connect, and make or check the tables; `lock_wait` is half a minute by default.

        Raises:
            InputError: there is no such place, or it holds something else.
            StudyBusyError: another program has locked it.
        """
        self.name, self.place = name, place
        self._lock_wait = lock_wait or LockWait()
        with self._sentences():
            self._connection = self._connect()
        try:
            with self._sentences():
                self._prepare()
        except BaseException:
            self._connection.close()
            raise

    def close(self) -> None:
        """Close the connection; nothing is pending outside a transaction."""
        self._connection.close()

    @abstractmethod
    def reading(self) -> AbstractContextManager[Connection]:
        """Give the connection for several reads of one state."""

    @abstractmethod
    def writing(self) -> AbstractContextManager[Connection]:
        """Give the connection for changes in one transaction, when those of others are done.

        Raises:
            InputError: the study cannot be changed.
            StudyBusyError: another program has locked it.
        """

    @abstractmethod
    def version(self) -> int | None:
        """Return a number that changes when another connection changes the study.

        Never waits for a lock, and is cheap enough to call every second. None if unknown.
        """

    @abstractmethod
    def continue_numbers(self) -> None:
        """Have new rows numbered after all copied ones, within a transaction of `writing`."""

    @abstractmethod
    def _connect(self) -> Any:
        """Return a new connection."""

    @abstractmethod
    def _prepare(self) -> None:
        """Make, check or migrate the tables."""

    @abstractmethod
    def _sentences(self) -> AbstractContextManager[None]:
        """Raise what the database reports as sentences for users."""
