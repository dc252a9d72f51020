"""A study in PostgreSQL: many seats, one study.

A reader sees one state of the study, however long it reads. A writer first changes the one row of
`rastrainer_study` and so waits for all writers before it, as those of an SQLite file do; the
number in that row tells the others that something has changed.

A lost connection is made anew by the next transaction. Where it was lost during a COMMIT, nobody
knows whether the change was stored. That is safe: trials, marks and truths are stored once by their
UUID and offered again until they are acknowledged, and steps are stored once by their name.
"""

from __future__ import annotations

import functools
import re
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

from rastrainer.errors import InputError
from rastrainer.study.database.address import PostgresAddress
from rastrainer.study.database.connection import Rows
from rastrainer.study.database.database import (
    LockWait,
    StudyAwayError,
    StudyBusyError,
    StudyDatabase,
)
from rastrainer.study.database.postgres_driver import postgres_driver, refuse_infinite_numbers
from rastrainer.study.database.postgres_errors import postgres_error
from rastrainer.study.database.schema import APPLICATION_ID, MIGRATIONS
from rastrainer.study.database.tables import in_postgres, study_tables

CONNECT_TIMEOUT_S = 10
INTERACTIVE_CONNECT_TIMEOUT_S = 2
"""The least that libpq takes."""
_JSON_EXTRACT = re.compile(r"json_extract\((\w+), '\$\.([\w.]+)'\)")
_SESSION = """
    SET search_path = public;
    SET timezone = 'UTC';
    SET synchronous_commit = on;
    SET statement_timeout = '60s';
    SET idle_in_transaction_session_timeout = '20s';
    SET tcp_keepalives_idle = 10;
    SET tcp_keepalives_interval = 5;
    SET tcp_keepalives_count = 3;
"""
"""A committed change survives a power failure, and a seat that has vanished blocks nobody."""
_NETWORK = {"keepalives_idle": 10, "keepalives_interval": 5, "tcp_user_timeout": 15_000}
_READ = "BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY"
_LOCKED = "UPDATE rastrainer_study SET changes = changes + 1"
_TABLES = """
    SELECT count(*) FROM pg_class WHERE relnamespace = 'public'::regnamespace AND relkind = 'r'
"""
_COMMANDS = """
    SELECT (SELECT count(*) FROM pg_class
            WHERE relnamespace = 'public'::regnamespace AND relkind NOT IN ('r', 'i', 'S'))
        + (SELECT count(*) FROM pg_trigger JOIN pg_class ON pg_class.oid = tgrelid
            WHERE relnamespace = 'public'::regnamespace AND NOT tgisinternal)
        + (SELECT count(*) FROM pg_rewrite JOIN pg_class ON pg_class.oid = ev_class
            WHERE relnamespace = 'public'::regnamespace)
        + (SELECT count(*) FROM pg_policy JOIN pg_class ON pg_class.oid = polrelid
            WHERE relnamespace = 'public'::regnamespace)
"""
_HEADER = """
    CREATE TABLE rastrainer_study (
        application_id BIGINT NOT NULL, user_version BIGINT NOT NULL, changes BIGINT NOT NULL
    )
"""


class PostgresDatabase(StudyDatabase):
    """A connection to one database; each process and thread may have one."""

    def __init__(
        self,
        address: PostgresAddress,
        lock_wait: LockWait | None = None,
        may_change: bool = True,
        may_create: bool = True,
    ) -> None:
        """Connect, create the tables in an empty database, and migrate older ones.

        Args:
            address: of the database, which exists.
            lock_wait: for locks of others; half a minute by default.
            may_change: False for reading only.
            may_create: whether an empty database becomes a study.

        Raises:
            InputError: the server refuses, the database is another program's, of a newer
                RASTrainer, or holds no study.
            StudyAwayError: the server cannot be reached.
        """
        self.name, self.place = address.database, address
        self._address = address
        self._lock_wait = lock_wait or LockWait()
        self._driver = postgres_driver()
        self._own_changes = 0
        self._may_change = may_change
        with self._sentences():
            self._connection = self._connect()
        try:
            with self._sentences():
                self._prepare(may_create)
        except BaseException:
            self._connection.close()
            raise

    def close(self) -> None:
        """Close the connection; nothing is pending outside a transaction."""
        self._connection.close()

    @contextmanager
    def reading(self) -> Iterator[_Statements]:
        """Give the connection for several reads of one state."""
        with self._transaction(_READ) as statements:
            yield statements

    @contextmanager
    def writing(self) -> Iterator[_Statements]:
        """Give the connection for changes in one transaction, when those of others are done."""
        if not self._may_change:
            raise InputError(f"The study {self._address} is read-only here.")
        with self._transaction(f"{self._begin_waiting()}; {_LOCKED}") as statements:
            yield statements
        self._own_changes += 1

    def version(self) -> int | None:
        """Return a number that changes when another connection changes the study."""
        try:
            with self.reading() as statements:
                changes = statements.execute("SELECT changes FROM rastrainer_study").fetchone()[0]
        except InputError:
            return None
        return changes - self._own_changes

    def continue_numbers(self) -> None:
        """Have new rows numbered after all copied ones, within a transaction of `writing`."""
        for table in study_tables():
            if table.order in ("id", "rowid") and table.name != "trainee_numbers":
                self._connection.execute(
                    f"SELECT setval(pg_get_serial_sequence('{table.name}', '{table.order}'), "
                    f"coalesce(max({table.order}), 0) + 1, false) FROM {table.name}"
                )

    @contextmanager
    def _transaction(self, begin: str) -> Iterator[_Statements]:
        with self._sentences():
            try:
                self._begin(begin)
                yield _Statements(self._connection)
                if self._connection.execute("COMMIT").statusmessage != "COMMIT":
                    raise InputError(f"The study {self._address} did not accept the change.")
            finally:
                if self._is_in_transaction():
                    self._connection.execute("ROLLBACK")

    def _begin(self, begin: str) -> None:
        if not self._connection.closed:
            try:
                self._connection.execute(begin)
                return
            except self._driver.OperationalError:
                if not self._connection.closed:
                    raise
        self._connection = self._connect()
        self._connection.execute(begin)

    def _begin_waiting(self) -> str:
        # 0 would be for ever.
        timeout_ms = max(1, round(1000 * self._lock_wait.timeout_s))
        return f"BEGIN; SET LOCAL lock_timeout = {timeout_ms}"

    def _is_in_transaction(self) -> bool:
        idle = self._driver.pq.TransactionStatus.IDLE
        return not self._connection.closed and self._connection.info.transaction_status != idle

    def _connect(self) -> Any:
        timeout_s = self._lock_wait.timeout_s
        if timeout_s == 0.0:
            # It has just failed: a window does not wait again so soon.
            raise StudyAwayError(f"The study {self._address} cannot be reached now.")
        connection = self._driver.connect(
            **self._address.connection_words,
            **_NETWORK,
            autocommit=True,
            prepare_threshold=None,
            application_name="RASTrainer",
            client_encoding="UTF8",
            connect_timeout=(
                INTERACTIVE_CONNECT_TIMEOUT_S if timeout_s < 1.0 else CONNECT_TIMEOUT_S
            ),
        )
        refuse_infinite_numbers(connection)
        connection.execute(_SESSION)
        return connection

    def _prepare(self, may_create: bool) -> None:
        if self._shown("server_encoding") != "UTF8":
            raise InputError(f"The database {self._address} must have the encoding UTF8.")
        if self._shown("fsync") != "on":
            raise InputError(
                f"The server of {self._address} runs with fsync = off and could lose trials that "
                "it has acknowledged; switch it on."
            )
        with self.reading():
            version = self._checked_version()
        if version == len(MIGRATIONS):
            return
        if not self._may_change:
            raise InputError(
                f"The study {self._address} is of an earlier RASTrainer and is only read here; "
                "open it once in Slicer, which migrates it."
                if version
                else f"The database {self._address} holds no study."
            )
        if version == 0 and not may_create:
            raise InputError(f"The database {self._address} holds no study.")
        self._migrate()

    def _checked_version(self) -> int:
        """Return how many steps the schema has taken; 0 in an empty database."""
        if self._number(_COMMANDS):
            raise InputError(
                f"The study {self._address} holds triggers, views, rules or policies; ours has "
                "none."
            )
        if self._number("SELECT count(*) FROM pg_tables WHERE tablename = 'rastrainer_study'"):
            row = self._connection.execute(
                "SELECT application_id, user_version FROM rastrainer_study"
            ).fetchall()
            if len(row) != 1 or row[0][0] != APPLICATION_ID:
                raise InputError(f"{self._address} is the database of another program.")
            version = row[0][1]
            if version > len(MIGRATIONS):
                raise InputError(
                    f"The study {self._address} was made by a newer RASTrainer (format {version}, "
                    f"this one knows {len(MIGRATIONS)}); update it."
                )
            return version
        if self._number(_TABLES):
            raise InputError(f"{self._address} is the database of another program.")
        return 0

    def _migrate(self) -> None:
        with self._transaction(self._begin_waiting()) as statements:
            # Another process may be creating or migrating the tables.
            statements.execute("SELECT pg_advisory_xact_lock(?)", (APPLICATION_ID,))
            version = self._checked_version()
            if version == 0:
                statements.execute(_HEADER)
                statements.execute(
                    "INSERT INTO rastrainer_study VALUES (?, 0, 0)", (APPLICATION_ID,)
                )
            statements.execute(_LOCKED)
            for step in MIGRATIONS[version:]:
                for statement in step:
                    statements.execute(in_postgres(statement))
            statements.execute("UPDATE rastrainer_study SET user_version = ?", (len(MIGRATIONS),))

    def _shown(self, setting: str) -> str:
        return self._connection.execute(f"SHOW {setting}").fetchone()[0]

    def _number(self, query: str) -> int:
        return self._connection.execute(query).fetchone()[0]

    @contextmanager
    def _sentences(self) -> Iterator[None]:
        try:
            yield
        except self._driver.Error as error:
            known = postgres_error(error, self._address)
            if known is None:
                raise
            if isinstance(known, StudyBusyError):
                self._lock_wait.note_timeout()
            raise known from error


class _Statements:
    """Gives PostgreSQL the statements of a study."""

    def __init__(self, connection: Any) -> None:
        self._connection = connection

    def execute(self, sql: str, parameters: Sequence[Any] = (), /) -> Rows:
        """Execute a statement with `?` for each parameter."""
        return self._connection.execute(portable_to_postgres(sql), parameters)

    def executemany(self, sql: str, parameters: Iterable[Sequence[Any]], /) -> None:
        """Execute a statement for each of several sequences of parameters."""
        with self._connection.cursor() as cursor:
            cursor.executemany(portable_to_postgres(sql), parameters)


@functools.cache
def portable_to_postgres(sql: str) -> str:
    """Return a statement with PostgreSQL's marks of parameters and way into JSON."""
    sql = _JSON_EXTRACT.sub(
        lambda found: f"({found[1]}::json #>> '{{{found[2].replace('.', ',')}}}')", sql
    )
    return sql.replace("%", "%%").replace("?", "%s")
