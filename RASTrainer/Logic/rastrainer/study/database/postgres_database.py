"""A study in PostgreSQL: many seats, one study.

A reader sees one state of the study, however long it reads. A writer first changes the one row of
`rastrainer_study` and so waits for all writers before it, as those of an SQLite file do; the
number in that row tells the others that something has changed.

A lost connection is made anew by the next transaction. Where it was lost during a COMMIT, nobody
knows whether the change was stored. That is safe: trials, marks and truths are stored once by their
UUID and offered again until they are acknowledged, and steps are stored once by their name.
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from rastrainer.errors import InputError
from rastrainer.study.database.address import PostgresAddress
from rastrainer.study.database.database import (
    LockWait,
    StudyAwayError,
    StudyBusyError,
    StudyDatabase,
)
from rastrainer.study.database.postgres_connecting import (
    INTERACTIVE_PATIENCE_S,
    connected,
    connected_within,
    postgres_driver,
    postgres_error,
)
from rastrainer.study.database.postgres_sql import (
    LOCKED,
    PostgresStatements,
    check_server,
    migrate,
    stored_version,
)
from rastrainer.study.database.schema import MIGRATIONS, study_tables

_READ = """
    BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY;
    SET LOCAL idle_in_transaction_session_timeout = 0;
    SET LOCAL statement_timeout = 0
"""
"""Who reads holds up nobody, and may take long, as for a copy of the whole study."""


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
        self._address = address
        self._driver = postgres_driver()
        self._own_changes = 0
        self._may_change, self._may_create = may_change, may_create
        super().__init__(address.database, address, lock_wait)

    @contextmanager
    def reading(self) -> Iterator[PostgresStatements]:
        """Give the connection for several reads of one state."""
        with self._transaction(_READ) as statements:
            yield statements

    @contextmanager
    def writing(self) -> Iterator[PostgresStatements]:
        """Give the connection for changes in one transaction, when those of others are done."""
        if not self._may_change:
            raise InputError(f"The study {self._address} is read-only here.")
        with self._transaction(f"{self._begin_waiting()}; {LOCKED}") as statements:
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
    def _transaction(self, begin: str) -> Iterator[PostgresStatements]:
        with self._sentences():
            try:
                self._begin(begin)
                yield PostgresStatements(self._connection)
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
        patience_s = self._lock_wait.timeout_s
        if patience_s == 0.0:
            # It has just failed: a window does not wait again so soon.
            raise StudyAwayError(f"The study {self._address} cannot be reached now.")
        if patience_s >= 1.0:
            return connected(self._address)
        begun = time.monotonic()
        try:
            return connected_within(INTERACTIVE_PATIENCE_S, self._address)
        except TimeoutError:
            self._lock_wait.note_timeout(time.monotonic() - begun)
            raise StudyAwayError(f"The study {self._address} cannot be reached now.") from None

    def _prepare(self) -> None:
        check_server(self._connection, self._address)
        with self.reading():
            version = stored_version(self._connection, self._address)
        if version == len(MIGRATIONS):
            return
        if version == 0 and not (self._may_change and self._may_create):
            raise InputError(f"The database {self._address} holds no study.")
        if not self._may_change:
            raise InputError(
                f"The study {self._address} is of an earlier RASTrainer and is only read here; "
                "open it once in Slicer, which migrates it."
            )
        with self._transaction(self._begin_waiting()) as statements:
            migrate(statements, self._address)

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
