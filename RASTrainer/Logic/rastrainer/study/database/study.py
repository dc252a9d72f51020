"""The study: trainees, their trials, registrations and scores, in one SQLite file.

Trials are stored by UUID, so that a trial delivered twice counts once. Results are added, never
overwritten; the latest count. Several processes may use one file at the same time.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rastrainer.errors import InputError
from rastrainer.files.writing import make_private_folder
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.study.database import study_trainees, study_trials
from rastrainer.study.database.database import LockWait, StudyDatabase
from rastrainer.study.database.reading import ReadOnlyStudyDatabase
from rastrainer.study.database.values import StoredTrial, Trainee, TrialOutcome
from rastrainer.trial.ctps import Trial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import TrialScore
from rastrainer.trial.trainee_progress import PastTrial

STUDY_FILE = "study.db"
"""The usual name."""


class Study:
    """A study's file; use it in a `with` statement, or call `close`.

    Every method raises `InputError` where the file cannot be read or written: read-only, damaged,
    disk full; `StudyBusyError` where another program has it locked for longer than the lock_wait
    lasts. One thread may use it.
    """

    def __init__(self, database: StudyDatabase) -> None:
        self._database = database
        self._read_trials: dict[str, tuple[tuple, StoredTrial]] = {}

    @classmethod
    def open(
        cls,
        path: str | os.PathLike[str],
        lock_wait: LockWait | None = None,
        make_folder: bool = False,
    ) -> Study:
        """Open the study in a file, or begin one there.

        Args:
            path: Of the file.
            lock_wait: With a lock held elsewhere; half a minute when left out.
            make_folder: Make a missing folder of the file, for its user alone.

        Raises:
            InputError: the file is no study, damaged, or of a newer RASTrainer; or the folder
                is missing or cannot be made.
            StudyBusyError: another program has it locked.
        """
        if make_folder:
            folder = Path(path).parent
            try:
                make_private_folder(folder)
            except OSError as error:
                raise InputError(f"The folder {folder} cannot be made: {error.strerror}.") from None
        return cls(StudyDatabase(path, lock_wait))

    @classmethod
    def open_for_reading(
        cls, path: str | os.PathLike[str], lock_wait: LockWait | None = None
    ) -> Study:
        """Open the study in a file, which stays as it is; what would change it is refused.

        Raises:
            InputError: as `open`, or there is no such file.
            StudyBusyError: another program has it locked.
        """
        return cls(ReadOnlyStudyDatabase(path, lock_wait))

    def __enter__(self) -> Study:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the file."""
        self._database.close()

    @property
    def database(self) -> StudyDatabase:
        """The file underneath, for `rastrainer.experiment`, which keeps its tables there too."""
        return self._database

    def create_trainee(self, pseudonym: str | None = None, consent: bool = False) -> Trainee:
        """Add a trainee, by default under the next free pseudonym (`T001`, `T002`, …).

        Raises:
            InputError: the pseudonym is taken, or cannot be one; see `json_checks.pseudonym`.
        """
        with self._database.writing() as connection:
            return study_trainees.create(connection, pseudonym, consent)

    def next_pseudonym(self) -> str:
        """Return the next free pseudonym, such as `T001`."""
        with self._database.reading() as connection:
            return study_trainees.next_pseudonym(connection)

    def trainees(self, archived: bool = False) -> tuple[Trainee, ...]:
        """Return those who train, or those who are archived, by pseudonym."""
        with self._database.reading() as connection:
            return study_trainees.listed(connection, archived)

    def trainee(self, pseudonym: str) -> Trainee:
        """Return a trainee; raise `InputError` if the study has none of this pseudonym."""
        with self._database.reading() as connection:
            return study_trainees.find(connection, pseudonym)

    def set_consent(self, pseudonym: str, consent: bool) -> Trainee:
        """Note whether a trainee agrees to research; raise `InputError` if there is none."""
        with self._database.writing() as connection:
            return study_trainees.change(connection, pseudonym, consent=consent)

    def set_archived(self, pseudonym: str, archived: bool) -> Trainee:
        """Hide a trainee from the list or show again; raise `InputError` if there is none."""
        with self._database.writing() as connection:
            return study_trainees.change(connection, pseudonym, archived=archived)

    def delete_trainee(self, pseudonym: str) -> int:
        """Delete a trainee with all trials and results, for good; return the number of trials.

        Should the simulator offer one of the trials again, `add_trial` refuses it.

        Raises:
            InputError: the study has none of this pseudonym.
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
        """Store a finished trial, with its results if they are known; return whether it was new.

        Of a trial that is already stored, nothing changes. A trainee whom the study does not know
        is added without consent, so that no trial is lost.

        Args:
            record: The trial, or the JSON object that holds it, which is checked.
            registrations: At most one of each kind.
            target_errors: By kind of registration.
            score: Our score of the trial.
            delivered: The object that the record was read from; its unknown keys are kept, too.

        Raises:
            InputError: the object is no record, or another trial has its UUID.
            DeletedTrialError: the trial was deleted with its trainee.
        """
        if not isinstance(record, TrialRecord):
            delivered = record
            record = TrialRecord.from_json(delivered)
        with self._database.writing() as connection:
            is_new = study_trials.add(connection, record, delivered or record.to_json())
            if is_new:
                study_trials.add_results(
                    connection, record.trial_id, registrations, target_errors or {}, score
                )
            return is_new

    def check_trial(self, record: TrialRecord) -> bool:
        """Return whether a trial would be new, before anything is computed from it.

        Raises:
            InputError: another trial has its UUID, or its trainee's name is no pseudonym.
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
    ) -> None:
        """Add what was computed from a stored trial; it counts from now on.

        Raises:
            InputError: the study has no such trial.
        """
        with self._database.writing() as connection:
            study_trials.add_results(
                connection, trial_id, registrations, target_errors or {}, score
            )

    def set_truth(self, trial_id: str, true_tre_mm: float, head_to_world: Sequence[float]) -> None:
        """Store what the simulator revealed of a trial; a second time changes nothing.

        Args:
            trial_id: UUID of a stored trial.
            true_tre_mm: True error at the scenario's target.
            head_to_world: 16 numbers row by row, RAS to `World`, mm.

        Raises:
            InputError: the study has no such trial, or these are not finite numbers.
        """
        with self._database.writing() as connection:
            study_trials.set_truth(connection, trial_id, true_tre_mm, head_to_world)

    def set_motion(self, trial_id: str, motion: Mapping[str, float]) -> None:
        """Store the motion metrics of a trial by name; a second time changes nothing.

        Raises:
            InputError: the study has no such trial, or a metric is no finite number.
        """
        with self._database.writing() as connection:
            study_trials.set_motion(connection, trial_id, motion)

    def trial(self, trial_id: str) -> StoredTrial:
        """Return a trial; raise `InputError` if the study has no such trial."""
        with self._database.reading() as connection:
            return study_trials.find(connection, trial_id)

    def is_revealed(self, trial_id: str) -> bool:
        """Return whether the truth of a stored trial is known."""
        with self._database.reading() as connection:
            return study_trials.is_revealed(connection, trial_id)

    def history(self, pseudonym: str) -> tuple[StoredTrial, ...]:
        """Return all trials of a trainee in the order they were started.

        Raises:
            InputError: the study has no trainee of this pseudonym.
        """
        with self._database.reading() as connection:
            return study_trials.history(connection, pseudonym, self._read_trials)

    def past_trials(self, pseudonym: str) -> tuple[PastTrial, ...]:
        """Return what progress is computed from: scored trials but the trial runs, as started.

        Raises:
            InputError: the study has no trainee of this pseudonym.
        """
        with self._database.reading() as connection:
            return study_trials.past_trials(connection, pseudonym)

    def outcomes(self, task: str, mode: str) -> tuple[TrialOutcome, ...]:
        """Return what all trials of a task and mode are compared by, as they were stored."""
        with self._database.reading() as connection:
            return study_trials.outcomes(connection, task, mode)

    def unrevealed(self) -> tuple[TrialRecord, ...]:
        """Return the trials whose truth the simulator has not revealed yet, oldest first."""
        with self._database.reading() as connection:
            return study_trials.unrevealed(connection)

    def cohort(self, mode: str | None = None) -> list[Trial]:
        """Return what CTPS compares: all registered trials of a mode but the trial runs.

        Args:
            mode: `desktop` or `hmd`; both when left out.
        """
        with self._database.reading() as connection:
            return study_trials.cohort(connection, mode)
