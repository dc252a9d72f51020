"""A study's database of either kind: its place, its transactions, and how long they wait.

An address of PostgreSQL never holds a password: libpq finds it in the user's own `~/.pgpass`, or in
PGPASSFILE or PGPASSWORD. So none gets into settings, histories of shells, lists of processes or
sentences.
"""

from __future__ import annotations

import os
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol
from urllib.parse import parse_qsl, quote, unquote, urlencode, urlsplit

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
    """A database of a PostgreSQL server.

    The host is a computer's name or number, or the folder of the socket on this one. Without user,
    it is the system's; without port, 5432.
    """

    host: str
    database: str
    user: str = ""
    port: int | None = None
    options: Mapping[str, str] = field(default_factory=dict)

    def __str__(self) -> str:
        """Return it as `study_place` reads it."""
        is_folder = self.host.startswith("/")
        user = f"{quote(self.user, safe='')}@" if self.user else ""
        host = "" if is_folder else f"[{self.host}]" if ":" in self.host else self.host
        port = "" if self.port is None else f":{self.port}"
        options = {**self.options, **({"host": self.host} if is_folder else {})}
        if is_folder and self.port is not None:
            port, options["port"] = "", str(self.port)
        end = f"?{urlencode(options, safe='/')}" if options else ""
        return f"{SCHEMES[0]}{user}{host}{port}/{quote(self.database, safe='')}{end}"

    @property
    def connection_options(self) -> dict[str, str]:
        """Options of libpq."""
        words = {"host": self.host, "dbname": self.database, **self.options}
        if self.user:
            words["user"] = self.user
        if self.port is not None:
            words["port"] = str(self.port)
        if not self.is_here:
            words.setdefault("sslmode", SAFE_MODES[0])
        return words

    @property
    def is_here(self) -> bool:
        """Whether its server runs on this computer."""
        return self.host in _HERE or self.host.startswith("/")


StudyPlace = Path | PostgresAddress
"""Where a study is: the path of its file, or the address of its database."""


def study_place(place: str | os.PathLike[str] | PostgresAddress) -> StudyPlace:
    """Return where a study is, from what a user has entered."""
    if isinstance(place, PostgresAddress):
        return place
    text = os.fspath(place)
    return _address(text) if text.startswith(SCHEMES) else Path(text)


def _address(text: str) -> PostgresAddress:
    # No sentence repeats what was entered: it might hold a password.
    if len(text) > _MAX_LENGTH or not text.isprintable():
        raise InputError(f"An address of PostgreSQL is printable text such as {EXAMPLE}.")
    try:
        parts = urlsplit(text)
        port, password = parts.port, parts.password
        pairs = parse_qsl(parts.query, keep_blank_values=True, strict_parsing=bool(parts.query))
    except ValueError:
        raise InputError(f"An address of PostgreSQL looks like {EXAMPLE}.") from None
    options = dict(pairs)
    if password is not None or "password" in options:
        raise InputError(
            "The address of a study must not hold a password, which would be kept in settings and "
            "seen by others. Put it into ~/.pgpass as HOST:PORT:DATABASE:USER:PASSWORD, readable "
            "by you alone."
        )
    unknown = sorted(set(options) - set(OPTIONS))
    if unknown or len(options) < len(pairs):
        raise InputError(
            "After its question mark, the address of a study may have each of "
            f"{', '.join(OPTIONS)} once."
        )
    host = options.pop("host", "") or parts.hostname or ""
    database = unquote(parts.path.removeprefix("/"))
    if not host or not database or "/" in database or "," in host or parts.fragment:
        raise InputError(f"The address of a study names a host and a database: {EXAMPLE}.")
    if "port" in options:
        text = options.pop("port")
        if not text.isdecimal() or not 0 < int(text[:6]) < 65536:
            raise InputError("The port of a study is a number from 1 to 65535.")
        port = int(text)
    user = unquote(parts.username or "")
    if not "".join((host, database, user, *options.values())).isprintable():
        raise InputError(f"An address of PostgreSQL is printable text such as {EXAMPLE}.")
    address = PostgresAddress(host, database, user, port, options)
    if not address.is_here and address.connection_options["sslmode"] not in SAFE_MODES:
        raise InputError(
            "A study on another computer is reached over TLS with a certificate that is checked: "
            f"leave sslmode out, or set it to {' or '.join(SAFE_MODES)}."
        )
    return address


BUSY_TIMEOUT_S = 30.0
INTERACTIVE_WAIT_S = (0.05, 1.0)
"""For a window's `LockWait`: not noticeable, and its rest."""


class Connection(Protocol):
    """A connection within a transaction; `sqlite3.Connection` is one.

    Statements are SQL that SQLite and PostgreSQL both know, with `?` for each parameter.
    `json_extract(column, '$.a.b')` is the one function that differs: its value may be a text.
    """

    def execute(self, sql: str, parameters: Sequence[Any] = ..., /) -> Any:
        """Execute a statement."""

    def executemany(self, sql: str, parameters: Iterable[Sequence[Any]], /) -> object:
        """Execute a statement for each of several sequences of parameters."""


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


class StudyUnreachableError(StudyBusyError):
    """The study's server cannot be reached; try again.

    Where the connection was lost while a change was being stored, it may or may not be stored.
    """


class StudyDatabase(ABC):
    """A connection to a study; each process and thread may have one."""

    _connection: Any
    _open: tuple[Connection, bool] | None = None
    """The open transaction, and whether it may change the study."""

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
            self._connection.close()
            raise

    def close(self) -> None:
        """Close the connection; nothing is pending outside a transaction."""
        self._connection.close()

    def rows(self, sql: str, *parameters: Any) -> list[Any]:
        """Return all rows that a query finds."""
        with self.reading() as connection:
            return connection.execute(sql, parameters).fetchall()

    def row(self, sql: str, *parameters: Any) -> Any:
        """Return the first row that a query finds, or None."""
        with self.reading() as connection:
            return connection.execute(sql, parameters).fetchone()

    def insert(self, table: str, is_once: bool = False, **values: Any) -> None:
        """Store a row; with `is_once`, not in place of one that has its key.

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
        with self.writing() as connection:
            connection.execute(sql, parameters)

    def reading(self) -> AbstractContextManager[Connection]:
        """Yield the connection for several reads of one state, or of the open transaction."""
        return self._joined(may_change=False)

    def writing(self) -> AbstractContextManager[Connection]:
        """Yield the connection for changes in one transaction, once those of others are done.

        Within another one of `writing`, the changes are part of that one.
        """
        return self._joined(may_change=True)

    @contextmanager
    def _joined(self, may_change: bool) -> Iterator[Connection]:
        if self._open is not None:
            connection, may_change_already = self._open
            if may_change and not may_change_already:
                raise RuntimeError("A study is changed within a transaction for reading.")
            yield connection
            return
        with self._transaction(may_change) as connection:
            self._open = connection, may_change
            try:
                yield connection
            finally:
                self._open = None

    @abstractmethod
    def version(self) -> int | None:
        """Return a number that changes when another connection changes the study.

        Never waits for a lock, and is cheap enough to call every second. None if unknown, as during
        a change.
        """

    @abstractmethod
    def continue_numbers(self) -> None:
        """Number new rows after all copied ones, within a transaction of `writing`."""

    @abstractmethod
    def _connect(self) -> Any:
        """Return a new connection."""

    @abstractmethod
    def _prepare(self) -> None:
        """Make or check the tables."""

    @abstractmethod
    def _transaction(self, may_change: bool) -> AbstractContextManager[Connection]:
        """Yield the connection in a new transaction."""

    @abstractmethod
    def _sentences(self) -> AbstractContextManager[None]:
        """Turn the database's errors into sentences for users."""
