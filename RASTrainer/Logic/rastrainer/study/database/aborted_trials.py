"""Aborted trials in a study: stored once, deleted with their trainee, counted in order."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from typing import Any

from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.study.database.study import Study, other_trial
from rastrainer.study.database.study_trainees import TRAINEE_ID
from rastrainer.study.database.values import decoded, moment, record_text, utc_now
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.trial_feedback import PastTrial


@dataclass(frozen=True)
class StoredAbortedTrial:
    """An aborted trial, and why it was repeated.

    Attributes:
        step: The study's step that was repeated because of it; "" if none.
    """

    record: AbortedTrial
    step: str = ""
    repeat_reason: str = ""


class AbortedTrials:
    """The aborted trials of one study. One thread may use it."""

    def __init__(self, study: Study) -> None:
        self._study = study

    def add(
        self, record: AbortedTrial | Mapping[str, Any], delivered: Mapping[str, Any] | None = None
    ) -> bool:
        """Store an aborted trial; return whether it was new.

        Of one in which nothing was done, only the number is noted. An unknown trainee is added
        without consent, as in `Study.add_trial`.

        Args:
            record: The trial, or its untrusted JSON object.
            delivered: The original object, whose unknown keys are stored too.

        Raises:
            DeletedTrialError: the trial was deleted with its trainee.
        """
        if not isinstance(record, AbortedTrial):
            delivered = record
            record = record_from_json(AbortedTrial, delivered)
        text, study = record_text(delivered or record_to_json(record)), self._study
        with study.database.writing() as connection:
            study.check_not_deleted(record.trial_id)
            row = connection.execute(
                "SELECT record_json FROM aborted_trials WHERE trial_id = ?", (record.trial_id,)
            ).fetchone()
            read = partial(record_from_json, AbortedTrial)
            is_other = row is not None and decoded(row[0], read) != record
            if is_other or study.has_trial(record.trial_id):
                raise other_trial(record.trial_id)
            if row is not None:
                return False
            study.note_delivery(record)
            if not record.is_kept:
                return False
            study.create_where_missing(record.trainee)
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

    def of(self, pseudonym: str) -> tuple[StoredAbortedTrial, ...]:
        """Return a trainee's aborted trials in order of starting; `InputError` if unknown."""
        with self._study.database.reading() as connection:
            self._study.trainee(pseudonym)
            rows = connection.execute(
                "SELECT record_json, coalesce(step, ''), coalesce(reason, '') "
                "FROM aborted_trials LEFT JOIN repeats USING (trial_id) "
                f"WHERE trainee_id = ({TRAINEE_ID}) ORDER BY aborted_trials.rowid",
                (pseudonym,),
            ).fetchall()
        found = [
            StoredAbortedTrial(decoded(text, partial(record_from_json, AbortedTrial)), step, reason)
            for text, step, reason in rows
        ]
        return tuple(sorted(found, key=lambda stored: moment(stored.record.started_utc)))

    def attempts(self, pseudonym: str) -> tuple[PastTrial, ...]:
        """Return the trials from which progress is computed, as started: scored and failed.

        Aborted trials with a touch have failed, and trials that can have no score.
        """
        with self._study.database.reading():
            scored = self._study.past_trials(pseudonym)
            aborted = [stored.record for stored in self.of(pseudonym)]
            failed: list[AbortedTrial | TrialRecord]
            failed = [record for record in aborted if record.counts_as_failed]
            failed += self._study.unscored(pseudonym)
        trials = [*scored, *map(PastTrial.failed, failed)]
        return tuple(sorted(trials, key=lambda trial: moment(trial.started_utc)))

    def unexplained(
        self, pseudonym: str, mode: str, task: str, since: datetime
    ) -> tuple[AbortedTrial, ...]:
        """Return the aborted trials of a task since a time, without a reason for their repeat."""
        return tuple(
            stored.record
            for stored in self.of(pseudonym)
            if not stored.repeat_reason
            and (stored.record.mode, stored.record.task) == (mode, task)
            and moment(stored.record.started_utc) >= since
        )

    def explain(self, trial_id: str, step: str, reason: str) -> None:
        """Store why a step is repeated after an aborted trial."""
        with self._study.database.writing() as connection:
            connection.execute(
                "INSERT INTO repeats VALUES (?, ?, ?, ?)", (trial_id, step, reason, utc_now())
            )
