"""The study: trainees, their trials, registrations and scores, in SQLite or PostgreSQL.

Trials are stored by UUID, so a trial delivered twice counts once. Results are added, never
overwritten; the latest count. Several processes may use one study at the same time.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files import writing
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.study.database import deliveries, study_trainees, study_trials
from rastrainer.study.database.database import LockWait, PostgresAddress, StudyDatabase, study_place
from rastrainer.study.database.postgres_database import PostgresDatabase
from rastrainer.study.database.sqlite_database import ReadOnlySqliteDatabase, SqliteDatabase
from rastrainer.study.database.values import StoredTrial, Trainee, TrialOutcome
from rastrainer.trial.ctps import Trial
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import TrialScore
from rastrainer.trial.trial_feedback import PastTrial

STUDY_FILE = "study.db"
"""The usual name."""


class Study:
    """A study; use it in a `with` statement, or call `close`.

    Every method raises `InputError` if the study cannot be read or written, `StudyBusyError` if
    another program has locked it for too long, and `StudyUnreachableError` if its server cannot be
    reached. For one thread.
    """

    def __init__(self, database: StudyDatabase) -> None:
        self._database = database
        self._read_trials: dict[str, tuple[tuple, StoredTrial]] = {}

    @classmethod
    def open(
        cls,
        place: str | os.PathLike[str] | PostgresAddress,
        lock_wait: LockWait | None = None,
        make_folder: bool = False,
        must_exist: bool = False,
    ) -> Study:
        """Open the study in a file or a database of PostgreSQL, or create one.

        Args:
            place: Path of the file, or the database's address.
            lock_wait: For locks of others; half a minute by default.
            make_folder: Create a missing folder of the file, private to its user.
            must_exist: Refuse a place that holds no study yet.

        Raises:
            InputError: the place is no study, damaged, or of a newer RASTrainer; or the folder is
                missing or cannot be made.
            StudyBusyError: another program has locked it.
            StudyUnreachableError: its server cannot be reached.
        """
        place = study_place(place)
        if isinstance(place, PostgresAddress):
            return cls(PostgresDatabase(place, lock_wait, may_create=not must_exist))
        if must_exist and not place.is_file():
            raise InputError(f"There is no file {place}.")
        if make_folder:
            writing.make_folder(place.parent, is_private=True)
        return cls(SqliteDatabase(place, lock_wait))

    @classmethod
    def open_for_reading(
        cls,
        place: str | os.PathLike[str] | PostgresAddress,
        lock_wait: LockWait | None = None,
    ) -> Study:
        """Open a study without changing it; changes are refused.

        Raises:
            InputError: as `open`, or there is no such study.
            StudyBusyError: another program has locked it.
            StudyUnreachableError: its server cannot be reached.
        """
        place = study_place(place)
        if isinstance(place, PostgresAddress):
            return cls(PostgresDatabase(place, lock_wait, may_change=False))
        return cls(ReadOnlySqliteDatabase(place, lock_wait))

    def __enter__(self) -> Study:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def close(self) -> None:
        self._database.close()

    @property
    def database(self) -> StudyDatabase:
        """The underlying database, for further tables of the study."""
        return self._database

    def create_trainee(self, pseudonym: str | None = None, consent: bool = False) -> Trainee:
        """Add a trainee, by default under the next free pseudonym (`T001`, `T002`, …)."""
        with self._database.writing() as connection:
            return study_trainees.create(connection, pseudonym, consent)

    def next_pseudonym(self) -> str:
        """Return the next free pseudonym, such as `T001`."""
        with self._database.reading() as connection:
            return study_trainees.next_pseudonym(connection)

    def trainees(self, archived: bool = False) -> tuple[Trainee, ...]:
        with self._database.reading() as connection:
            return study_trainees.listed(connection, archived)

    def trainee(self, pseudonym: str) -> Trainee:
        """Return a trainee; raise `InputError` if unknown."""
        with self._database.reading() as connection:
            return study_trainees.find(connection, pseudonym)

    def set_consent(self, pseudonym: str, consent: bool) -> Trainee:
        """Store whether a trainee consents to research; raise `InputError` if unknown."""
        with self._database.writing() as connection:
            return study_trainees.change(connection, pseudonym, consent=consent)

    def set_archived(self, pseudonym: str, archived: bool) -> Trainee:
        """Hide a trainee from the list or show them again; raise `InputError` if unknown."""
        with self._database.writing() as connection:
            return study_trainees.change(connection, pseudonym, archived=archived)

    def delete_trainee(self, pseudonym: str) -> int:
        """Delete a trainee with all trials and results for good; return the number of trials.

        `add_trial` refuses these trials from now on.
        """
        self._read_trials.clear()
        with self._database.writing() as connection:
            return study_trainees.delete(connection, pseudonym)

    def add_trial(
        self,
        record: TrialRecord | Mapping[str, Any],
        registrations: Iterable[Registration] = (),
        target_errors: Mapping[str, TargetError] | None = None,
        score: TrialScore | None = None,
        delivered: Mapping[str, Any] | None = None,
    ) -> bool:
        """Store a finished trial with its results, if known; return whether it was new.

        A trial that is already stored is not changed. An unknown trainee is added without consent,
        so that no trial is lost.

        Args:
            record: The trial, or its untrusted JSON object.
            registrations: At most one of each kind.
            target_errors: By kind of registration.
            score: Our score of the trial.
            delivered: The original object, whose unknown keys are stored too.

        Raises:
            InputError: the record is invalid, or another trial has its UUID.
            DeletedTrialError: the trial was deleted with its trainee.
        """
        if not isinstance(record, TrialRecord):
            delivered = record
            record = record_from_json(TrialRecord, delivered)
        with self._database.writing() as connection:
            is_new = study_trials.add(connection, record, delivered or record_to_json(record))
            if is_new:
                study_trials.add_results(
                    connection, record.trial_id, registrations, target_errors or {}, score
                )
            return is_new

    def check_trial(self, record: TrialRecord) -> bool:
        """Return whether a trial would be new, before anything is computed from it.

        Raises:
            InputError: another trial has its UUID, or its trainee's name is not a valid pseudonym.
            DeletedTrialError: the trial was deleted with its trainee.
        """
        with self._database.reading() as connection:
            return study_trials.check(connection, record)

    def add_results(
        self,
        trial_id: str,
        registrations: Iterable[Registration] = (),
        target_errors: Mapping[str, TargetError] | None = None,
        score: TrialScore | None = None,
        procedure: ProcedureOutcome | None = None,
    ) -> None:
        """Add results of a stored trial; the latest ones count."""
        with self._database.writing() as connection:
            study_trials.add_results(
                connection, trial_id, registrations, target_errors or {}, score, procedure
            )

    def set_truth(self, trial_id: str, true_tre_mm: float, head_to_world: Sequence[float]) -> None:
        """Store the truth that the simulator revealed; only the first one counts.

        Args:
            trial_id: UUID of a stored trial.
            true_tre_mm: True error at the scenario's target.
            head_to_world: 16 numbers row by row, RAS to `World`, mm.
        """
        with self._database.writing() as connection:
            study_trials.set_truth(connection, trial_id, true_tre_mm, head_to_world)

    def set_motion(self, trial_id: str, motion: Mapping[str, float]) -> None:
        """Store the motion metrics of a trial by name; only the first ones count."""
        with self._database.writing() as connection:
            study_trials.set_motion(connection, trial_id, motion)

    def trial(self, trial_id: str) -> StoredTrial:
        """Return a trial; raise `InputError` if unknown."""
        with self._database.reading() as connection:
            return study_trials.find(connection, trial_id)

    def is_revealed(self, trial_id: str) -> bool:
        """Return whether the truth of a stored trial is known."""
        with self._database.reading() as connection:
            return study_trials.is_revealed(connection, trial_id)

    def history(self, pseudonym: str) -> tuple[StoredTrial, ...]:
        """Return all trials of a trainee in order of starting."""
        with self._database.reading() as connection:
            return study_trials.history(connection, pseudonym, self._read_trials)

    def past_trials(self, pseudonym: str) -> tuple[PastTrial, ...]:
        """Return the scored trials, without trial runs, from which progress is computed."""
        with self._database.reading() as connection:
            return study_trials.past_trials(connection, pseudonym)

    def outcomes(self, task: str, mode: str) -> tuple[TrialOutcome, ...]:
        with self._database.reading() as connection:
            return study_trials.outcomes(connection, task, mode)

    def undelivered(self) -> Mapping[str, tuple[tuple[int, int], ...]]:
        """Return the gaps in what arrived, by series; see `deliveries.missing`."""
        with self._database.reading() as connection:
            return deliveries.missing(connection)

    def unrevealed(self) -> tuple[TrialRecord, ...]:
        """Return the records of trials without truth, oldest first."""
        with self._database.reading() as connection:
            return study_trials.unrevealed(connection)

    def cohort(self, mode: str | None = None) -> list[Trial]:
        """Return the registered trials of a mode (or all), without trial runs, for CTPS."""
        with self._database.reading() as connection:
            return study_trials.cohort(connection, mode)
