"""Which trials were deleted from a study: known again when offered again, and nothing else.

Kept are hashes of random UUIDs. They hold no name, no time and no number, and who does not have the
trial's record cannot learn from them that there was one.
"""

from __future__ import annotations

import hashlib
import sqlite3
from collections.abc import Iterable

from rastrainer.errors import InputError


class DeletedTrialError(InputError):
    """The trial was deleted from the study together with its trainee."""


def bury(connection: sqlite3.Connection, trial_ids: Iterable[str]) -> None:
    """Remember that these trials are deleted."""
    connection.executemany(
        "INSERT OR IGNORE INTO deleted_trials VALUES (?)",
        ((_sha256(trial_id),) for trial_id in trial_ids),
    )


def check_not_buried(connection: sqlite3.Connection, trial_id: str) -> None:
    """Raise `DeletedTrialError` where the trial was deleted."""
    query = "SELECT 1 FROM deleted_trials WHERE trial_sha256 = ?"
    if connection.execute(query, (_sha256(trial_id),)).fetchone() is not None:
        raise DeletedTrialError(
            "The trial was deleted from the study with its trainee and is not stored again."
        )


def _sha256(trial_id: str) -> str:
    return hashlib.sha256(trial_id.encode()).hexdigest()
