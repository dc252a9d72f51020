"""The study: trainees, their trials, registrations and scores, in SQLite or PostgreSQL.

Trials are stored by UUID, so a trial delivered twice counts once. Results are added, never
overwritten; the latest count. Several processes may use one study at the same time.
"""

from __future__ import annotations

import itertools
import json
import os
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from rastrainer import json_checks
from rastrainer.errors import InputError
from rastrainer.files import writing
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import TRIAL_RUN, RegistrationMethod
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.study.database.database import LockWait, PostgresAddress, study_place
from rastrainer.study.database.postgres_database import PostgresDatabase
from rastrainer.study.database.sqlite_database import ReadOnlySqliteDatabase, SqliteDatabase
from rastrainer.study.database.study_trainees import TRAINEE_ID, StudyTrainees, check_pseudonym
from rastrainer.study.database.values import (
    StoredProcedure,
    StoredRegistration,
    StoredTrial,
    TrialOutcome,
    decoded,
    json_text,
    record_text,
    utc_now,
)
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import TrialScore
from rastrainer.trial.trial_feedback import PastTrial

STUDY_FILE = "study.db"
"""The usual name."""
TRUTH_LIMIT = 1e6
MOTION_LIMIT = 1e9

METHOD = "coalesce(json_extract(record_json, '$.method'), 'fiducials')"
"""The method by which a trial was registered: its record leaves out fiducials, the default."""

_STAMPED_TRIALS = f"""
    SELECT trial_id, rowid, stored_utc,
        (SELECT max(id) FROM registrations WHERE registrations.trial_id = trials.trial_id),
        (SELECT max(id) FROM scores WHERE scores.trial_id = trials.trial_id),
        (SELECT max(id) FROM procedure_outcomes
            WHERE procedure_outcomes.trial_id = trials.trial_id),
        (SELECT stored_utc FROM truths WHERE truths.trial_id = trials.trial_id),
        (SELECT stored_utc FROM motions WHERE motions.trial_id = trials.trial_id)
    FROM trials WHERE trainee_id = ({TRAINEE_ID}) ORDER BY started_utc, rowid
"""
"""Each trial of a trainee with a stamp that changes with any stored result."""


class Study(StudyTrainees):
    """A study; use it in a `with` statement, or call `close`.

    Every method raises `InputError` if the study cannot be read or written, `StudyBusyError` if
    another program has locked it for too long, and `StudyUnreachableError` if its server cannot be
    reached. For one thread. Methods that are called within `database.writing()` or `reading()` are
    part of that transaction.
    """

    _read_trials: Mapping[str, tuple[tuple, StoredTrial]] = {}
    """History of the last trainee, each trial with a stamp that changes with it."""

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
        cls, place: str | os.PathLike[str] | PostgresAddress, lock_wait: LockWait | None = None
    ) -> Study:
        """Open a study without changing it; changes are refused."""
        place = study_place(place)
        if isinstance(place, PostgresAddress):
            return cls(PostgresDatabase(place, lock_wait, may_change=False))
        return cls(ReadOnlySqliteDatabase(place, lock_wait))

    def __enter__(self) -> Study:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def close(self) -> None:
        self.database.close()

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
            DeletedTrialError: the trial was deleted with its trainee.
        """
        if not isinstance(record, TrialRecord):
            delivered = record
            record = record_from_json(TrialRecord, delivered)
        text = record_text(delivered or record_to_json(record))
        with self.database.writing() as connection:
            if not self.check_trial(record):
                return False
            self.note_delivery(record)
            self.create_where_missing(record.trainee)
            connection.execute(
                f"INSERT INTO trials VALUES (?, ({TRAINEE_ID}), ?, ?, ?, ?, ?, ?, ?)",
                (
                    record.trial_id,
                    record.trainee,
                    record.task,
                    record.mode,
                    record.scenario,
                    record.started_utc,
                    record.completion_time_s,
                    text,
                    utc_now(),
                ),
            )
            if record.motion:
                self.set_motion(record.trial_id, record.motion)
            self.add_results(record.trial_id, registrations, target_errors, score)
        return True

    def check_trial(self, record: TrialRecord) -> bool:
        """Return whether a trial would be new, before anything is computed from it.

        Raises:
            DeletedTrialError: the trial was deleted with its trainee.
        """
        with self.database.reading():
            self.check_not_deleted(record.trial_id)
            if self.has_trial(record.trial_id):
                # The seed is the simulator's secret at first and may be revealed later.
                if replace(self.record(record.trial_id), seed=None) != replace(record, seed=None):
                    raise other_trial(record.trial_id)
                return False
            if not self.has_trainee(record.trainee):
                check_pseudonym(record.trainee)
            return True

    def has_trial(self, trial_id: str) -> bool:
        return self._has("trials", trial_id)

    def is_revealed(self, trial_id: str) -> bool:
        """Return whether the truth of a stored trial is known."""
        return self._has("truths", trial_id)

    def _has(self, table: str, trial_id: str) -> bool:
        with self.database.reading() as connection:
            query = f"SELECT 1 FROM {table} WHERE trial_id = ?"
            return connection.execute(query, (trial_id,)).fetchone() is not None

    def _check_exists(self, trial_id: str) -> None:
        if not self.has_trial(trial_id):
            raise InputError(f"The study has no trial {json.dumps(str(trial_id)[:64])}.")

    def create_where_missing(self, pseudonym: str, consent: bool = False) -> None:
        """Add the trainee of a record unless they exist."""
        if not self.has_trainee(pseudonym):
            self.create_trainee(pseudonym, consent)

    def note_delivery(self, record: AbortedTrial | TrialRecord) -> None:
        """Note that a trial has arrived; one without a number, from elsewhere, leaves no trace."""
        if record.number and record.series:
            with self.database.writing() as connection:
                connection.execute(
                    "INSERT INTO deliveries VALUES (?, ?) ON CONFLICT DO NOTHING",
                    (record.series, record.number),
                )

    def undelivered(self) -> Mapping[str, tuple[tuple[int, int], ...]]:
        """Return the first and last numbers of each gap in what arrived, by series.

        A simulator numbers all trials that are started in its folder, so a gap is a trial that went
        to another study, that still waits there, or that somebody has made vanish.
        """
        with self.database.reading() as connection:
            query = "SELECT series, number FROM deliveries ORDER BY series, number"
            rows = connection.execute(query).fetchall()
        gaps = defaultdict(list)
        for (series, number), (same, following) in itertools.pairwise(rows):
            if same == series and following > number + 1:
                gaps[series].append((number + 1, following - 1))
        return {series: tuple(found) for series, found in gaps.items()}

    def add_results(
        self,
        trial_id: str,
        registrations: Iterable[Registration] = (),
        target_errors: Mapping[str, TargetError] | None = None,
        score: TrialScore | None = None,
        procedure: ProcedureOutcome | None = None,
    ) -> None:
        """Add results of a stored trial; the latest results count."""
        with self.database.writing() as connection:
            self._check_exists(trial_id)
            for registration in registrations:
                error = (target_errors or {}).get(registration.kind)
                stored = json_text(record_to_json(StoredRegistration.of(registration, error)))
                connection.execute(
                    "INSERT INTO registrations "
                    "(trial_id, kind, fre_mm, registration_json, stored_utc) "
                    "VALUES (?, ?, ?, ?, ?)",
                    (trial_id, registration.kind, registration.fre_mm, stored, utc_now()),
                )
            if score is not None:
                connection.execute(
                    "INSERT INTO scores (trial_id, score, version, score_json, stored_utc) "
                    "VALUES (?, ?, ?, ?, ?)",
                    (
                        trial_id,
                        score.score,
                        score.version,
                        json_text(record_to_json(score, with_defaults=True)),
                        utc_now(),
                    ),
                )
            if procedure is not None:
                found, outcome = procedure.score, StoredProcedure.of(procedure).to_json()
                connection.execute(
                    "INSERT INTO procedure_outcomes "
                    "(trial_id, score, version, outcome_json, stored_utc) VALUES (?, ?, ?, ?, ?)",
                    (trial_id, found.score, found.version, json_text(outcome), utc_now()),
                )

    def set_truth(self, trial_id: str, true_tre_mm: float, head_to_world: Sequence[float]) -> None:
        """Store the truth that the simulator revealed; only the first one counts.

        Args:
            trial_id: UUID of a stored trial.
            true_tre_mm: True error at the scenario's target.
            head_to_world: 16 numbers row by row, RAS to `World`, mm.
        """
        with self.database.writing() as connection:
            self._check_exists(trial_id)
            what = "What the simulator reveals"
            error = json_checks.accepted(json_checks.number(0, TRUTH_LIMIT), true_tre_mm, what)
            pose = json_checks.accepted(json_checks.numbers(16, TRUTH_LIMIT), head_to_world, what)
            connection.execute(
                "INSERT INTO truths VALUES (?, ?, ?, ?) ON CONFLICT DO NOTHING",
                (trial_id, error, json_text(pose), utc_now()),
            )

    def set_motion(self, trial_id: str, motion: Mapping[str, float]) -> None:
        """Store the motion metrics of a trial by name; later metrics change nothing."""
        check_value = json_checks.number(-MOTION_LIMIT, MOTION_LIMIT)
        with self.database.writing() as connection:
            self._check_exists(trial_id)
            checked = {
                json_checks.accepted(json_checks.text(), name, "A motion metric"): (
                    json_checks.accepted(check_value, value, "A motion metric")
                )
                for name, value in motion.items()
            }
            connection.execute(
                "INSERT INTO motions VALUES (?, ?, ?) ON CONFLICT DO NOTHING",
                (trial_id, json_text(checked), utc_now()),
            )

    def record(self, trial_id: str) -> TrialRecord:
        """Return the record of a trial; raise `InputError` if unknown."""
        with self.database.reading() as connection:
            self._check_exists(trial_id)
            query = "SELECT record_json FROM trials WHERE trial_id = ?"
            (text,) = connection.execute(query, (trial_id,)).fetchone()
        return decoded(text, partial(record_from_json, TrialRecord))

    def trial(self, trial_id: str) -> StoredTrial:
        """Return a trial with its latest results; raise `InputError` if unknown."""
        with self.database.reading() as connection:
            record = self.record(trial_id)

            def rows(columns: str, table: str, order: str = "") -> list[Any]:
                query = f"SELECT {columns} FROM {table} WHERE trial_id = ? {order}"
                return connection.execute(query, (trial_id,)).fetchall()

            registrations = rows("kind, registration_json", "registrations", "ORDER BY id")
            scores = rows("score_json", "scores", "ORDER BY id")
            truths = rows("true_tre_mm, head_to_world_json", "truths")
            motions = rows("motion_json", "motions")
            procedures = rows("outcome_json", "procedure_outcomes", "ORDER BY id")
        return StoredTrial(
            record=record,
            registrations={kind: decoded(text, _registration) for kind, text in registrations},
            score=decoded(scores[-1][0], partial(record_from_json, TrialScore)) if scores else None,
            true_tre_mm=truths[0][0] if truths else None,
            head_to_world=decoded(truths[0][1], tuple) if truths else None,
            motion=decoded(motions[0][0], dict) if motions else {},
            procedure=(
                decoded(procedures[-1][0], StoredProcedure.from_json) if procedures else None
            ),
        )

    def history(self, pseudonym: str) -> tuple[StoredTrial, ...]:
        """Return all trials of a trainee in order of starting; unchanged trials are kept."""
        with self.database.reading() as connection:
            self.trainee(pseudonym)
            known = self._read_trials
            self._read_trials = {
                trial_id: known[trial_id]
                if trial_id in known and known[trial_id][0] == tuple(stamp)
                else (tuple(stamp), self.trial(trial_id))
                for trial_id, *stamp in connection.execute(_STAMPED_TRIALS, (pseudonym,)).fetchall()
            }
        return tuple(trial for _stamp, trial in self._read_trials.values())

    def past_trials(self, pseudonym: str) -> tuple[PastTrial, ...]:
        """Return a trainee's scored trials without trial runs, in order of starting."""
        with self.database.reading() as connection:
            self.trainee(pseudonym)
            rows = connection.execute(
                "SELECT * FROM ("
                "SELECT trial_id, task, mode, completion_time_s, scenario, started_utc, "
                f"{METHOD} AS method, ({_latest('scores', 'score_json')}) AS latest, "
                f"({_latest('procedure_outcomes', 'outcome_json')}), trials.rowid AS stored "
                f"FROM trials WHERE trainee_id = ({TRAINEE_ID}) AND task != ?"
                ") AS played WHERE latest IS NOT NULL ORDER BY started_utc, stored",
                (pseudonym, TRIAL_RUN),
            )
            # Row by row, so that not all records are in memory together.
            return tuple(_past_trial(*row) for row in rows)

    def unscored(self, pseudonym: str) -> tuple[TrialRecord, ...]:
        """Return a trainee's trials that can have no score, since their truth is known.

        Trial runs are left out.
        """
        return self._records(
            f"trainee_id = ({TRAINEE_ID}) AND task != ? "
            "AND trial_id IN (SELECT trial_id FROM truths) "
            "AND trial_id NOT IN (SELECT trial_id FROM scores)",
            (pseudonym, TRIAL_RUN),
        )

    def unrevealed(self) -> tuple[TrialRecord, ...]:
        """Return the records of trials without truth, oldest first."""
        return self._records("trial_id NOT IN (SELECT trial_id FROM truths)")

    def _records(self, condition: str, parameters: Sequence[Any] = ()) -> tuple[TrialRecord, ...]:
        with self.database.reading() as connection:
            rows = connection.execute(
                f"SELECT record_json FROM trials WHERE {condition} ORDER BY rowid", parameters
            ).fetchall()
        return tuple(decoded(text, partial(record_from_json, TrialRecord)) for (text,) in rows)

    def outcomes(self, task: str, mode: str) -> tuple[TrialOutcome, ...]:
        """Return the outcomes of all trials of a task and mode, in order of storing."""
        with self.database.reading() as connection:
            rows = connection.execute(
                f"""
                SELECT trials.trial_id, pseudonym, completion_time_s,
                    ({_latest("scores", "score")}), {METHOD}, true_tre_mm
                FROM trials
                JOIN trainees ON trainees.id = trainee_id
                LEFT JOIN truths ON truths.trial_id = trials.trial_id
                WHERE task = ? AND mode = ?
                ORDER BY trials.rowid
                """,
                (task, mode),
            ).fetchall()
        return tuple(TrialOutcome(*row) for row in rows)


def _registration(value: Any) -> StoredRegistration:
    return record_from_json(StoredRegistration, value, "The stored registration")


def _latest(table: str, column: str) -> str:
    """Return the query for the latest result of a trial."""
    own = f"WHERE {table}.trial_id = trials.trial_id ORDER BY {table}.id DESC LIMIT 1"
    return f"SELECT {column} FROM {table} {own}"


def _past_trial(
    trial_id: str,
    task: str,
    mode: str,
    seconds: float,
    scenario: str,
    started_utc: str,
    method: str,
    score_json: str,
    outcome_json: str | None,
    _rowid: int,
) -> PastTrial:
    score = decoded(score_json, partial(record_from_json, TrialScore))
    done = None if outcome_json is None else decoded(outcome_json, StoredProcedure.from_json)
    return PastTrial(
        *(trial_id, task, mode, seconds, score.score, score.acceptable),
        method=RegistrationMethod(method),
        scenario=scenario,
        started_utc=started_utc,
        parts=score.parts,
        procedure="" if done is None else done.name,
        procedure_score=None if done is None else done.score,
    )


def other_trial(trial_id: str) -> InputError:
    return InputError(f"Another trial is stored under the UUID {trial_id}; the stored one is kept.")
