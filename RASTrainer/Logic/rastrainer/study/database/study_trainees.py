"""The trainees of a study, and the trials that were deleted with them."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable

from rastrainer import json_checks
from rastrainer.errors import InputError
from rastrainer.study.database.database import StudyDatabase
from rastrainer.study.database.values import Trainee, utc_now

TRAINEE_ID = "SELECT id FROM trainees WHERE pseudonym = ?"
_SELECT = "SELECT pseudonym, consent, archived, created_utc FROM trainees"


class DeletedTrialError(InputError):
    """The trial was deleted from the study together with its trainee."""


class StudyTrainees:
    """The trainees of a study.

    Attributes:
        database: The underlying database, for further tables of the study.
    """

    def __init__(self, database: StudyDatabase) -> None:
        self.database = database

    def create_trainee(self, pseudonym: str | None = None, consent: bool = False) -> Trainee:
        """Add a trainee, by default under the next free pseudonym (`T001`, `T002`, …)."""
        with self.database.writing() as connection:
            pseudonym = self.next_pseudonym() if pseudonym is None else pseudonym
            check_pseudonym(pseudonym)
            if self.has_trainee(pseudonym):
                raise InputError(f"The pseudonym {json.dumps(pseudonym)} is taken; choose another.")
            connection.execute(
                "INSERT INTO trainees (pseudonym, consent, archived, created_utc) "
                "VALUES (?, ?, 0, ?)",
                (pseudonym, int(consent), utc_now()),
            )
            connection.execute("UPDATE trainee_numbers SET latest = latest + 1")
            return self.trainee(pseudonym)

    def next_pseudonym(self) -> str:
        """Return the next free pseudonym, such as `T001`."""
        with self.database.reading() as connection:
            # Numbers of deleted trainees are not reused, to avoid confusion.
            number = connection.execute("SELECT latest FROM trainee_numbers").fetchone()[0] + 1
            while self.has_trainee(f"T{number:03d}"):
                number += 1
        return f"T{number:03d}"

    def has_trainee(self, pseudonym: str) -> bool:
        with self.database.reading() as connection:
            return connection.execute(TRAINEE_ID, (pseudonym,)).fetchone() is not None

    def trainees(self, archived: bool = False) -> tuple[Trainee, ...]:
        """Return active or archived trainees by pseudonym."""
        with self.database.reading() as connection:
            rows = connection.execute(
                f"{_SELECT} WHERE archived = ? ORDER BY pseudonym", (int(archived),)
            ).fetchall()
        return tuple(_trainee(row) for row in rows)

    def trainee(self, pseudonym: str) -> Trainee:
        """Return a trainee; raise `InputError` if unknown."""
        with self.database.reading() as connection:
            row = connection.execute(f"{_SELECT} WHERE pseudonym = ?", (pseudonym,)).fetchone()
        if row is None:
            raise InputError(f"The study has no trainee {json.dumps(str(pseudonym)[:64])}.")
        return _trainee(row)

    def set_consent(self, pseudonym: str, consent: bool) -> Trainee:
        """Store whether a trainee consents to research; raise `InputError` if unknown."""
        return self._set(pseudonym, "consent", consent)

    def set_archived(self, pseudonym: str, archived: bool) -> Trainee:
        """Hide a trainee from the list or show them again; raise `InputError` if unknown."""
        return self._set(pseudonym, "archived", archived)

    def _set(self, pseudonym: str, column: str, value: bool) -> Trainee:
        with self.database.writing() as connection:
            connection.execute(
                f"UPDATE trainees SET {column} = ? WHERE pseudonym = ?", (int(value), pseudonym)
            )
            return self.trainee(pseudonym)

    def delete_trainee(self, pseudonym: str) -> int:
        """Delete a trainee with all trials and results for good; return the number of trials.

        These trials are refused from now on.
        """
        with self.database.writing() as connection:
            self.trainee(pseudonym)
            finished, aborted = (
                connection.execute(
                    f"SELECT trial_id FROM {table} WHERE trainee_id = ({TRAINEE_ID})", (pseudonym,)
                ).fetchall()
                for table in ("trials", "aborted_trials")
            )
            self._mark_deleted(trial_id for (trial_id,) in (*finished, *aborted))
            connection.execute("DELETE FROM trainees WHERE pseudonym = ?", (pseudonym,))
        return len(finished)

    def _mark_deleted(self, trial_ids: Iterable[str]) -> None:
        # Only hashes of the random UUIDs are stored: without the record, no one can learn that a
        # trial existed.
        with self.database.writing() as connection:
            connection.executemany(
                "INSERT INTO deleted_trials VALUES (?) ON CONFLICT DO NOTHING",
                ((_sha256(trial_id),) for trial_id in trial_ids),
            )

    def is_deleted(self, trial_id: str) -> bool:
        """Return whether a trial was deleted with its trainee."""
        with self.database.reading() as connection:
            query = "SELECT 1 FROM deleted_trials WHERE trial_sha256 = ?"
            return connection.execute(query, (_sha256(trial_id),)).fetchone() is not None

    def check_not_deleted(self, trial_id: str) -> None:
        if self.is_deleted(trial_id):
            raise DeletedTrialError(
                "The trial was deleted from the study with its trainee and is not stored again."
            )


def check_pseudonym(pseudonym: str, what: str = "A pseudonym") -> str:
    """Return a valid pseudonym; raise `InputError` for any other text."""
    return json_checks.accepted(json_checks.pseudonym(), pseudonym, what)


def _trainee(row: tuple[str, int, int, str]) -> Trainee:
    pseudonym, consent, archived, created_utc = row
    return Trainee(pseudonym, bool(consent), bool(archived), created_utc)


def _sha256(trial_id: str) -> str:
    return hashlib.sha256(trial_id.encode()).hexdigest()
