"""Which user of a learning platform is which trainee, in a private file beside the study.

The study itself holds nothing that a platform knows a person by.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.files.reading import printable_name
from rastrainer.files.writing import open_private

WAIT_S = 30.0
_TABLES = """
CREATE TABLE IF NOT EXISTS users (
    issuer TEXT NOT NULL,
    subject TEXT NOT NULL,
    pseudonym TEXT NOT NULL UNIQUE,
    PRIMARY KEY (issuer, subject)
);
CREATE TABLE IF NOT EXISTS assignments (
    issuer TEXT NOT NULL,
    client_id TEXT NOT NULL,
    subject TEXT NOT NULL,
    line_item TEXT NOT NULL,
    task TEXT NOT NULL,
    mode TEXT NOT NULL,
    method TEXT NOT NULL,
    rule TEXT NOT NULL,
    launched_utc TEXT NOT NULL,
    sent_score REAL,
    sent_utc TEXT,
    PRIMARY KEY (issuer, subject, line_item),
    FOREIGN KEY (issuer, subject) REFERENCES users (issuer, subject) ON DELETE CASCADE
);
"""
_COLUMNS = (
    "issuer, client_id, subject, line_item, task, mode, method, rule, launched_utc, sent_score, "
    "sent_utc"
)


@dataclass(frozen=True)
class LinkedAssignment:
    """A column of a course's gradebook, for one user who has opened its link.

    Attributes:
        subject: Of the user at the platform.
        line_item: URL of the column.
        task, mode: Whose trials count; "" for any.
        method: Of registration, a `RegistrationMethod`.
        rule: Which of these trials counts.
        launched_utc: When the link was opened last, ISO 8601.
        sent_score: That the platform has confirmed, 0 to 100; None if none.
        sent_utc: When, ISO 8601; None if never.
    """

    issuer: str
    client_id: str
    subject: str
    line_item: str
    task: str
    mode: str
    method: str
    rule: str
    launched_utc: str
    sent_score: float | None = None
    sent_utc: str | None = None


class PlatformLinks:
    """The file; several processes may use it at the same time.

    Every method raises `InputError` if it cannot be read or written.
    """

    def __init__(self, study: Path) -> None:
        """Use the file beside a study; it is created when something is first written to it."""
        self.path = study.with_name(f"{study.name}.lti.db")

    def pseudonym(self, issuer: str, subject: str) -> str | None:
        """Return the trainee that a platform's user is in the study; None if none yet."""
        with self._opened() as database:
            query = "SELECT pseudonym FROM users WHERE issuer = ? AND subject = ?"
            row = database.execute(query, (issuer, subject)).fetchone()
        return row[0] if row else None

    def pseudonyms(self) -> set[str]:
        with self._opened() as database:
            return {name for (name,) in database.execute("SELECT pseudonym FROM users")}

    def users(self, pseudonym: str) -> list[dict[str, str]]:
        """Return the platforms and users by which a trainee is known."""
        if not self.path.exists():
            return []
        query = "SELECT issuer, subject FROM users WHERE pseudonym = ?"
        with self._opened() as database:
            rows = database.execute(query, (pseudonym,)).fetchall()
        return [{"issuer": issuer, "subject": subject} for issuer, subject in rows]

    def link(self, issuer: str, subject: str, pseudonym: str) -> None:
        with self._opened() as database:
            database.execute("INSERT INTO users VALUES (?, ?, ?)", (issuer, subject, pseudonym))

    def forget(self, pseudonym: str) -> None:
        """Delete a trainee's user and assignments; having none is no error."""
        if self.path.exists():
            with self._opened() as database:
                database.execute("DELETE FROM users WHERE pseudonym = ?", (pseudonym,))

    def copy_to(self, other: PlatformLinks) -> int:
        """Copy everything beside a new copy of the study; return the number of users.

        Without this, learners would start over, and lower grades would replace theirs.
        """
        if not self.path.exists():
            return 0
        with self._opened() as database:
            users = database.execute("SELECT * FROM users").fetchall()
            query = f"SELECT {_COLUMNS} FROM assignments ORDER BY rowid"
            assignments = database.execute(query).fetchall()
        if users:
            with other._opened() as database:
                # A study that was empty has no trainees whom these could be.
                database.execute("DELETE FROM users")
                database.executemany("INSERT INTO users VALUES (?, ?, ?)", users)
                marks = ", ".join("?" * len(_COLUMNS.split(", ")))
                database.executemany(
                    f"INSERT INTO assignments ({_COLUMNS}) VALUES ({marks})", assignments
                )
        return len(users)

    def put(self, assignment: LinkedAssignment) -> None:
        """Store an assignment of a linked user, or its new terms; what was sent is kept."""
        with self._opened() as database:
            database.execute(
                f"INSERT INTO assignments ({_COLUMNS}) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?) "
                "ON CONFLICT (issuer, subject, line_item) DO UPDATE SET "
                "client_id = excluded.client_id, task = excluded.task, mode = excluded.mode, "
                "method = excluded.method, rule = excluded.rule, "
                "launched_utc = excluded.launched_utc",
                tuple(vars(assignment).values()),
            )

    def assignments(self) -> list[tuple[str, LinkedAssignment]]:
        """Return all assignments, each with the pseudonym of its trainee."""
        query = f"SELECT pseudonym, {_COLUMNS} FROM assignments JOIN users USING (issuer, subject)"
        with self._opened() as database:
            rows = database.execute(f"{query} ORDER BY assignments.rowid").fetchall()
        return [(pseudonym, LinkedAssignment(*values)) for pseudonym, *values in rows]

    def note_sent(self, assignment: LinkedAssignment, score: float, utc: str) -> None:
        """Remember that the platform has confirmed a score."""
        key = (assignment.issuer, assignment.subject, assignment.line_item)
        with self._opened() as database:
            database.execute(
                "UPDATE assignments SET sent_score = ?, sent_utc = ? "
                "WHERE issuer = ? AND subject = ? AND line_item = ?",
                (score, utc, *key),
            )

    @contextlib.contextmanager
    def _opened(self) -> Iterator[sqlite3.Connection]:
        """Yield the file for one transaction."""
        try:
            # Private before there is anything in it.
            with contextlib.suppress(FileExistsError):
                os.close(open_private(self.path, os.O_RDWR | os.O_CREAT | os.O_EXCL))
            with contextlib.closing(sqlite3.connect(self.path, timeout=WAIT_S)) as database:
                database.execute("PRAGMA trusted_schema = OFF")
                # Deleted users leave no bytes behind.
                database.execute("PRAGMA secure_delete = ON")
                database.execute("PRAGMA foreign_keys = ON")
                database.execute("PRAGMA synchronous = EXTRA")
                database.executescript(_TABLES)
                with database:
                    yield database
        except (OSError, sqlite3.Error) as error:
            raise InputError(
                f"The links to learning platforms in {printable_name(self.path)} cannot be used: "
                f"{error}."
            ) from None
