"""A study's database of either kind: its place, its transactions, and how long they wait.

An address of PostgreSQL never holds a password: libpq finds it in the user's own `~/.pgpass`, or in
PGPASSFILE or PGPASSWORD. So none gets into settings, histories of shells, lists of processes or
sentences.
"""

from __future__ import annotations

import os
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl, unquote, urlsplit

from rastrainer.errors import InputError
from rastrainer.study.database.schema import TABLES, TRAINEE_ID
from rastrainer.study.database.values import utc_now

SCHEMES = ("postgresql://", "postgres://")
EXAMPLE = "postgresql://USER@HOST/DATABASE"
OPTIONS = ("sslmode", "sslrootcert", "sslcert", "sslkey", "passfile", "host", "port")
"""Options that an address may have after its question mark."""
SAFE_MODES = ("verify-full", "verify-ca")
"""Values of `sslmode` that prevent eavesdropping and impersonation between two computers."""
_HERE = ("localhost", "127.0.0.1", "::1")
_MAX_LENGTH = 1000


@dataclass(frozen=True)
class PostgresAddress:
    """A database of a PostgreSQL server; the host may be the folder of a socket.

    `uri`, checked, is for libpq. Its default `sslmode` (None) is enough on this computer.
    """

    uri: str
    host: str
    database: str
    sslmode: str | None

    def __str__(self) -> str:
        return self.uri


StudyPlace = Path | PostgresAddress
"""Where a study is: the path of its file, or the address of its database."""


def study_place(place: str | os.PathLike[str] | PostgresAddress) -> StudyPlace:
    """Return where a study is, from what a user has entered."""
    if isinstance(place, PostgresAddress):
        return place
    text = os.fspath(place)
    return _address(text) if text.startswith(SCHEMES) else Path(text)


def _address(uri: str) -> PostgresAddress:
    # No sentence repeats the entered address: it might hold a password.
    if len(uri) > _MAX_LENGTH or not unquote(uri).isprintable():
        raise InputError(f"An address of PostgreSQL is printable text such as {EXAMPLE}.")
    try:
        parts = urlsplit(uri)
        port = parts.port or 1
        pairs = parse_qsl(parts.query, keep_blank_values=True, strict_parsing=bool(parts.query))
    except ValueError:
        raise InputError(f"An address of PostgreSQL looks like {EXAMPLE}.") from None
    options = dict(pairs)
    if parts.password is not None or "password" in options:
        raise InputError(
            "The address of a study must not hold a password, which would be kept in settings and "
            "seen by others. Put it into ~/.pgpass as HOST:PORT:DATABASE:USER:PASSWORD, readable "
            "by you alone."
        )
    if set(options) - set(OPTIONS) or len(options) < len(pairs):
        raise InputError(
            "After its question mark, the address of a study may have each of "
            f"{', '.join(OPTIONS)} once."
        )
    host = options.get("host", "") or parts.hostname or ""
    database = unquote(parts.path.removeprefix("/"))
    if not host or not database or "/" in database or "," in host or parts.fragment:
        raise InputError(f"The address of a study names a host and a database: {EXAMPLE}.")
    number = options.get("port", str(port))
    if not number.isdecimal() or not 0 < int(number[:6]) < 65536:
        raise InputError("The port of a study is a number from 1 to 65535.")
    is_here = host in _HERE or host.startswith("/")
    sslmode = options.get("sslmode", None if is_here else SAFE_MODES[0])
    if not is_here and sslmode not in SAFE_MODES:
        raise InputError(
            "A study on another computer is reached over TLS with a certificate that is checked: "
            f"leave sslmode out, or set it to {' or '.join(SAFE_MODES)}."
        )
    return PostgresAddress(uri, host, database, sslmode)


BUSY_TIMEOUT_S = 30.0
INTERACTIVE_WAIT_S = (0.05, 1.0)
"""For a window's `LockWait`: not noticeable, and its rest."""


class LockWait:
    """How long to wait for a lock; for some time after a timeout, not at all.

    A panel queries a study ten times in a row: if another program holds a lock, it waits `most_s`
    once, and not again within `rest_s`. Several connections may share one.
    """

    def __init__(
        self,
        most_s: float = BUSY_TIMEOUT_S,
        rest_s: float = 0.0,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._most_s, self._rest_s, self._clock = most_s, rest_s, clock
        self._retry_at = float("-inf")
        self._has_timed_out = False

    @property
    def timeout_s(self) -> float:
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


class StudyUnreachableError(StudyBusyError):
    """The study's server cannot be reached; try again.

    Where the connection was lost while a change was being stored, it may or may not be stored.
    """


class StudyDatabase(ABC):
    """A connection to a study; each process and thread may have one.

    Statements are SQL that SQLite and PostgreSQL both know, with `?` for each parameter.
    """

    _connection: Any
    _errors: type[Exception]
    """Base class of the library's errors."""
    _may_change_now: bool | None = None
    """Whether the open transaction may change the study; None without one."""

    def __init__(self, name: str, place: StudyPlace, lock_wait: LockWait | None) -> None:
        """Connect, and make or check the tables; `lock_wait` is half a minute by default."""
        self.name, self.place = name, place
        self._lock_wait = lock_wait or LockWait()
        with self._sentences():
            self._connection = self._connect()
        try:
            with self._sentences():
                self._prepare()
        except BaseException:
            self.close()
            raise

    def close(self) -> None:
        self._connection.close()

    def rows(self, sql: str, *parameters: Any) -> list[Any]:
        with self.reading():
            return self._execute(sql, *parameters).fetchall()

    def row(self, sql: str, *parameters: Any) -> Any:
        with self.reading():
            return self._execute(sql, *parameters).fetchone()

    def insert(self, table: str, is_once: bool = False, **values: Any) -> None:
        """Store a row; with `is_once`, keep a stored row that has the same key.

        `trainee` is a pseudonym; the time of storing is added where the table has it.
        """
        if "stored_utc" in TABLES[table].columns:
            values["stored_utc"] = utc_now()
        names = ["trainee_id" if name == "trainee" else name for name in values]
        marks = [f"({TRAINEE_ID})" if name == "trainee" else "?" for name in values]
        self.change(
            f"INSERT INTO {table} ({', '.join(names)}) VALUES ({', '.join(marks)})"
            f"{' ON CONFLICT DO NOTHING' if is_once else ''}",
            *values.values(),
        )

    def change(self, sql: str, *parameters: Any) -> None:
        with self.writing():
            self._execute(sql, *parameters)

    def reading(self) -> AbstractContextManager[None]:
        """Read one state of the study several times, within an open transaction if there is one."""
        return self._transaction(may_change=False)

    def writing(self) -> AbstractContextManager[None]:
        """Make changes in one transaction, after the transactions of others.

        Within another one of `writing`, the changes are part of that one.
        """
        return self._transaction(may_change=True)

    @contextmanager
    def _transaction(self, may_change: bool) -> Iterator[None]:
        if self._may_change_now is not None:
            if may_change and not self._may_change_now:
                raise RuntimeError("A study is changed within a transaction for reading.")
            yield
            return
        with self._sentences():
            try:
                self._begin(may_change)
                self._may_change_now = may_change
                yield
                self._commit()
            finally:
                self._may_change_now = None
                self._roll_back()

    @contextmanager
    def _sentences(self) -> Iterator[None]:
        """Turn the library's errors into sentences for users."""
        try:
            yield
        except self._errors as error:
            known = self._explained(error)
            if known is None:
                raise
            if isinstance(known, StudyBusyError):
                self._lock_wait.note_timeout()
            raise known from error

    def _execute(self, sql: str, *parameters: Any) -> Any:
        return self._connection.execute(sql, parameters)

    @abstractmethod
    def version(self) -> int | None:
        """Return a number that changes when another connection changes the study.

        Never waits for a lock, and is cheap enough to call every second. None if unknown, as during
        a change.
        """

    @abstractmethod
    def continue_numbers(self) -> None:
        """Number new rows after all copied rows, within a transaction of `writing`."""

    @abstractmethod
    def _connect(self) -> Any:
        """Return a new connection."""

    @abstractmethod
    def _prepare(self) -> None:
        """Make or check the tables."""

    @abstractmethod
    def _begin(self, may_change: bool) -> None:
        """Begin a transaction."""

    @abstractmethod
    def _commit(self) -> None:
        """End the transaction."""

    @abstractmethod
    def _roll_back(self) -> None:
        """Undo a transaction that was begun and not committed."""

    @abstractmethod
    def _explained(self, error: Any) -> InputError | None:
        """Return what to tell the user of the library's error; None if it is a bug of ours."""
