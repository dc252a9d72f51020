"""Aborted trials in a study: stored once, deleted with their trainee, counted in order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from typing import Any

from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.study.database import deliveries, study_trainees, study_trials
from rastrainer.study.database.database import Connection
from rastrainer.study.database.study import Study
from rastrainer.study.database.study_trainees import TRAINEE_ID, check_not_deleted
from rastrainer.study.database.study_trials import decoded, record_text
from rastrainer.study.database.values import moment, utc_now
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.trial_feedback import PastTrial


@dataclass(frozen=True)
class StoredAbortedTrial:
    """An aborted trial, and why it was repeated.

    Attributes:
        record: As delivered by the simulator.
        step: The study step that it belonged to; "" if none.
        repeat_reason: Why that step was repeated; "" if no reason was given.
    """

    record: AbortedTrial
    step: str = ""
    repeat_reason: str = ""


class AbortedTrials:
    """The aborted trials of one study. One thread may use it."""

    def __init__(self, study: Study) -> None:
        self._database = study.database

    def add(
        self, record: AbortedTrial | Mapping[str, Any], delivered: Mapping[str, Any] | None = None
    ) -> bool:
        """Store an aborted trial; return whether it was new.

        Of one in which nothing was done, only the number is noted.

        An unknown trainee is added without consent, as in `Study.add_trial`.

        Args:
            record: The trial, or its untrusted JSON object.
            delivered: The original object, whose unknown keys are stored too.

        Raises:
            InputError: the record is invalid or larger than 1 MiB, or another trial has its UUID.
            DeletedTrialError: the trial was deleted with its trainee.
        """
        if not isinstance(record, AbortedTrial):
            delivered = record
            record = record_from_json(AbortedTrial, delivered)
        text = record_text(delivered or record_to_json(record))
        with self._database.writing() as connection:
            return _add(connection, record, text)

    def of(self, pseudonym: str) -> tuple[StoredAbortedTrial, ...]:
        """Return a trainee's aborted trials in order of starting; `InputError` if unknown."""
        with self._database.reading() as connection:
            study_trainees.find(connection, pseudonym)
            return stored_of(connection, pseudonym)

    def attempts(self, pseudonym: str) -> tuple[PastTrial, ...]:
        """Return what progress is computed from, as started: scored trials and failures.

        Failures are aborted trials with a touch, and trials that can have no score.
        """
        with self._database.reading() as connection:
            scored = study_trials.past_trials(connection, pseudonym)
            started = dict(
                connection.execute(
                    f"SELECT trial_id, started_utc FROM trials WHERE trainee_id = ({TRAINEE_ID})",
                    (pseudonym,),
                )
            )
            timed = [(moment(started[trial.trial_id]), trial) for trial in scored]
            timed += [
                (moment(stored.record.started_utc), PastTrial.failed(stored.record))
                for stored in stored_of(connection, pseudonym)
                if stored.record.counts_as_failed
            ]
            timed += [
                (moment(record.started_utc), PastTrial.failed(record))
                for record in study_trials.unscored(connection, pseudonym)
            ]
            return tuple(trial for _when, trial in sorted(timed, key=lambda each: each[0]))


def stored_of(connection: Connection, pseudonym: str) -> tuple[StoredAbortedTrial, ...]:
    """Return the aborted trials of a trainee in order of starting."""
    rows = connection.execute(
        "SELECT record_json, coalesce(step, ''), coalesce(reason, '') FROM aborted_trials "
        "LEFT JOIN repeats USING (trial_id) "
        f"WHERE trainee_id = ({TRAINEE_ID}) ORDER BY aborted_trials.rowid",
        (pseudonym,),
    ).fetchall()
    found = [
        StoredAbortedTrial(decoded(text, partial(record_from_json, AbortedTrial)), step, reason)
        for text, step, reason in rows
    ]
    return tuple(sorted(found, key=lambda stored: moment(stored.record.started_utc)))


def unexplained(
    connection: Connection, pseudonym: str, mode: str, task: str, since: datetime
) -> tuple[AbortedTrial, ...]:
    """Return the aborted trials of a task since a time, without a reason for their repeat."""
    return tuple(
        stored.record
        for stored in stored_of(connection, pseudonym)
        if not stored.repeat_reason
        and (stored.record.mode, stored.record.task) == (mode, task)
        and moment(stored.record.started_utc) >= since
    )


def explain(connection: Connection, trial_id: str, step: str, reason: str) -> None:
    """Store why a step is repeated after an aborted trial."""
    connection.execute(
        "INSERT INTO repeats VALUES (?, ?, ?, ?)", (trial_id, step, reason, utc_now())
    )


def _add(connection: Connection, record: AbortedTrial, text: str) -> bool:
    check_not_deleted(connection, record.trial_id)
    row = connection.execute(
        "SELECT record_json FROM aborted_trials WHERE trial_id = ?", (record.trial_id,)
    ).fetchone()
    is_other = (
        row is not None and decoded(row[0], partial(record_from_json, AbortedTrial)) != record
    )
    if is_other or study_trials.exists(connection, record.trial_id):
        raise InputError(
            f"Another trial is stored under the UUID {record.trial_id}; the stored one is kept."
        )
    if row is not None:
        return False
    deliveries.note(connection, record)
    if not record.is_kept:
        return False
    study_trainees.create_where_missing(connection, record.trainee, consent=False)
    connection.execute(
        f"INSERT INTO aborted_trials VALUES (?, ({TRAINEE_ID}), ?, ?, ?, ?, ?, ?)",
        (
            record.trial_id,
            record.trainee,
            record.task,
            record.mode,
            record.scenario,
            record.started_utc,
            text,
            utc_now(),
        ),
    )
    return True
