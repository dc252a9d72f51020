"""Trainees in a study's database; each function runs in the caller's transaction, see `Study`."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable

from rastrainer import json_checks
from rastrainer.errors import InputError
from rastrainer.study.database.database import Connection
from rastrainer.study.database.values import Trainee, utc_now


class DeletedTrialError(InputError):
    """The trial was deleted from the study together with its trainee."""


def mark_deleted(connection: Connection, trial_ids: Iterable[str]) -> None:
    """Remember that these trials are deleted.

    Only hashes of the random UUIDs are stored: without the record, no one can learn that a trial
    existed.
    """
    connection.executemany(
        "INSERT INTO deleted_trials VALUES (?) ON CONFLICT DO NOTHING",
        ((_sha256(trial_id),) for trial_id in trial_ids),
    )


def check_not_deleted(connection: Connection, trial_id: str) -> None:
    """Raise `DeletedTrialError` if the trial was deleted."""
    query = "SELECT 1 FROM deleted_trials WHERE trial_sha256 = ?"
    if connection.execute(query, (_sha256(trial_id),)).fetchone() is not None:
        raise DeletedTrialError(
            "The trial was deleted from the study with its trainee and is not stored again."
        )


def _sha256(trial_id: str) -> str:
    return hashlib.sha256(trial_id.encode()).hexdigest()


TRAINEE_ID = "SELECT id FROM trainees WHERE pseudonym = ?"
_SELECT = "SELECT pseudonym, consent, archived, created_utc FROM trainees"


def create(connection: Connection, pseudonym: str | None, consent: bool) -> Trainee:
    """Add a trainee, by default with the next free pseudonym."""
    pseudonym = next_pseudonym(connection) if pseudonym is None else pseudonym
    check_pseudonym(pseudonym)
    if exists(connection, pseudonym):
        raise InputError(f"The pseudonym {json.dumps(pseudonym)} is taken; choose another.")
    connection.execute(
        "INSERT INTO trainees (pseudonym, consent, archived, created_utc) VALUES (?, ?, 0, ?)",
        (pseudonym, int(consent), utc_now()),
    )
    connection.execute("UPDATE trainee_numbers SET latest = latest + 1")
    return find(connection, pseudonym)


def check_pseudonym(pseudonym: str) -> None:
    """Raise `InputError` if a text is not a valid pseudonym."""
    try:
        json_checks.pseudonym()(pseudonym)
    except ValueError as error:
        raise InputError(f"A pseudonym must be {error}.") from None


def create_where_missing(connection: Connection, pseudonym: str, consent: bool) -> None:
    """Add the trainee of a record unless they exist."""
    if not exists(connection, pseudonym):
        create(connection, pseudonym, consent)


def exists(connection: Connection, pseudonym: str) -> bool:
    return connection.execute(TRAINEE_ID, (pseudonym,)).fetchone() is not None


def find(connection: Connection, pseudonym: str) -> Trainee:
    """Return a trainee; raise `InputError` if unknown."""
    row = connection.execute(f"{_SELECT} WHERE pseudonym = ?", (pseudonym,)).fetchone()
    if row is None:
        raise InputError(f"The study has no trainee {json.dumps(str(pseudonym)[:64])}.")
    return _trainee(row)


def listed(connection: Connection, archived: bool) -> tuple[Trainee, ...]:
    """Return active or archived trainees by pseudonym."""
    rows = connection.execute(
        f"{_SELECT} WHERE archived = ? ORDER BY pseudonym", (int(archived),)
    ).fetchall()
    return tuple(_trainee(row) for row in rows)


def change(
    connection: Connection,
    pseudonym: str,
    consent: bool | None = None,
    archived: bool | None = None,
) -> Trainee:
    """Change the given values of a trainee."""
    trainee = find(connection, pseudonym)
    connection.execute(
        "UPDATE trainees SET consent = ?, archived = ? WHERE pseudonym = ?",
        (
            int(trainee.consent if consent is None else consent),
            int(trainee.archived if archived is None else archived),
            pseudonym,
        ),
    )
    return find(connection, pseudonym)


def delete(connection: Connection, pseudonym: str) -> int:
    """Delete a trainee with all trials; return the number of finished ones."""
    find(connection, pseudonym)
    finished, aborted = (
        [
            trial_id
            for (trial_id,) in connection.execute(
                f"SELECT trial_id FROM {table} WHERE trainee_id = ({TRAINEE_ID})", (pseudonym,)
            )
        ]
        for table in ("trials", "aborted_trials")
    )
    mark_deleted(connection, (*finished, *aborted))
    connection.execute("DELETE FROM trainees WHERE pseudonym = ?", (pseudonym,))
    return len(finished)


def next_pseudonym(connection: Connection) -> str:
    """Return the next free pseudonym."""
    # Numbers of deleted trainees are not reused, to avoid confusion.
    number = connection.execute("SELECT latest FROM trainee_numbers").fetchone()[0] + 1
    while exists(connection, f"T{number:03d}"):
        number += 1
    return f"T{number:03d}"


def _trainee(row: tuple[str, int, int, str]) -> Trainee:
    pseudonym, consent, archived, created_utc = row
    return Trainee(pseudonym, bool(consent), bool(archived), created_utc)
