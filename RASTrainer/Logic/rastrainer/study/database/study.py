"""The study: trainees, their trials, registrations and scores, in SQLite or PostgreSQL.

Trials are stored by UUID, so a trial delivered twice counts once. Results are added, never
overwritten; the latest count. Several processes may use one study at the same time.
"""

from __future__ import annotations

import hashlib
import itertools
import json
import os
from collections import defaultdict
from collections.abc import Iterable, Mapping
from contextlib import AbstractContextManager
from dataclasses import replace
from enum import Enum
from typing import Any

from rastrainer import json_checks
from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError
from rastrainer.files import writing
from rastrainer.head.trial_head import UNMOVED
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import TRIAL_RUN
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.study.database.database import LockWait, PostgresAddress, StudyDatabase, study_place
from rastrainer.study.database.postgres_database import PostgresDatabase
from rastrainer.study.database.schema import TABLES, TRAINEE_ID
from rastrainer.study.database.sqlite_database import SqliteDatabase
from rastrainer.study.database.values import (
    PROCEDURE,
    RESULTS,
    SCORE,
    TRUTH,
    StoredRegistration,
    StoredTrial,
    Trainee,
    decoded_record,
    json_text,
    moment,
    result_of,
    utc_now,
)
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.record import AbortedTrial, TrialRecord
from rastrainer.trial.scoring import TrialScore
from rastrainer.trial.trial_row import TrialRow

STUDY_FILE = "study.db"
"""The usual name."""
RECORD_LIMIT_BYTES = 2**20

Delivered = TrialRecord | AbortedTrial | DrillRecord
_RECORDS: Mapping[str, type[Delivered]] = {
    "trials": TrialRecord,
    "aborted_trials": AbortedTrial,
    "drills": DrillRecord,
}
"""The tables of what the simulator delivers."""
_TRAINEES = "SELECT pseudonym, consent, archived, created_utc FROM trainees"
_STAMPED_TRIALS = f"""
    SELECT trial_id, id, stored_utc,
        (SELECT max(results.id) FROM results WHERE results.trial_id = trials.trial_id)
    FROM trials WHERE trainee_id = ({TRAINEE_ID}) ORDER BY started_utc, id
"""
"""Each trial of a trainee with a stamp that changes with any stored result."""


def _latest(column: str, kind: str) -> str:
    """Return a query of the latest result of a kind, within one of `trials`."""
    own = f"WHERE results.trial_id = trials.trial_id AND kind = '{kind}'"
    return f"(SELECT {column} FROM results {own} ORDER BY results.id DESC LIMIT 1)"


_NAMES = ("trainee", "mode", "task", "trial_id", "started_utc", "scenario", "method")
_ATTEMPTS = f"""
    SELECT pseudonym, {", ".join(_NAMES[1:])}, completion_time_s,
        {_latest("result_json", SCORE)}, {_latest("result_json", PROCEDURE)},
        {_latest("value", TRUTH)}
    FROM trials JOIN trainees ON trainees.id = trainee_id
    WHERE pseudonym = ? AND task != ? ORDER BY trials.id
"""
_OUTCOMES = f"""
    SELECT trial_id, pseudonym, method, completion_time_s,
        {_latest("value", SCORE)}, {_latest("value", TRUTH)}
    FROM trials JOIN trainees ON trainees.id = trainee_id
    WHERE task = ? AND mode = ? ORDER BY trials.id
"""


class DeletedTrialError(InputError):
    """The trial was deleted from the study together with its trainee."""


class Study(AbstractContextManager["Study"]):
    """A study; use it in a `with` statement, or call `close`.

    Every method raises `InputError` if the study cannot be read or written, `StudyBusyError` if
    another program has locked it for too long, and `StudyUnreachableError` if its server cannot be
    reached. For one thread. Methods that are called within `database.writing()` or `reading()` are
    part of that transaction.
    """

    def __init__(self, database: StudyDatabase) -> None:
        self.database = database
        self._read_trials: Mapping[str, tuple[list, StoredTrial]] = {}
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

        A folder that is made is private to its user.
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
        place = study_place(place)
        if isinstance(place, PostgresAddress):
            return cls(PostgresDatabase(place, lock_wait, may_change=False))
        return cls(SqliteDatabase(place, lock_wait, may_change=False))

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def close(self) -> None:
        self.database.close()

    def create_trainee(self, pseudonym: str | None = None, consent: bool = False) -> Trainee:
        """Add a trainee, by default under the next free pseudonym (`T001`, `T002`, …)."""
        with self.database.writing():
            pseudonym = self.next_pseudonym() if pseudonym is None else pseudonym
            json_checks.accepted(json_checks.pseudonym, pseudonym, "A pseudonym")
            if self.has_trainee(pseudonym):
                raise InputError(f"The pseudonym {json.dumps(pseudonym)} is taken; choose another.")
            trainee = Trainee(pseudonym, consent, archived=False, created_utc=utc_now())
            self.database.insert(
                "trainees", **{**vars(trainee), "consent": int(consent), "archived": 0}
            )
            self.database.change("UPDATE trainee_numbers SET latest = latest + 1")
            return trainee

    def next_pseudonym(self) -> str:
        with self.database.reading():
            # Numbers of deleted trainees are not reused, to avoid confusion.
            number = self.database.row("SELECT latest FROM trainee_numbers")[0] + 1
            while self.has_trainee(f"T{number:03d}"):
                number += 1
        return f"T{number:03d}"

    def has_trainee(self, pseudonym: str) -> bool:
        return self.database.row(TRAINEE_ID, pseudonym) is not None

    def trainees(self, archived: bool | None = False) -> tuple[Trainee, ...]:
        """Return the active or the archived trainees, by pseudonym; with None, all of them."""
        query = f"{_TRAINEES} WHERE archived = coalesce(?, archived) ORDER BY pseudonym"
        wanted = None if archived is None else int(archived)
        return tuple(_trainee(*row) for row in self.database.rows(query, wanted))

    def trainee(self, pseudonym: str) -> Trainee:
        row = self.database.row(f"{_TRAINEES} WHERE pseudonym = ?", pseudonym)
        if row is None:
            raise InputError(f"The study has no trainee {json.dumps(str(pseudonym)[:64])}.")
        return _trainee(*row)

    def change_trainee(
        self, pseudonym: str, consent: bool | None = None, archived: bool | None = None
    ) -> Trainee:
        """Store whether a trainee consents to research, or is hidden from the list."""
        with self.database.writing():
            self.database.change(
                "UPDATE trainees SET consent = coalesce(?, consent), "
                "archived = coalesce(?, archived) WHERE pseudonym = ?",
                None if consent is None else int(consent),
                None if archived is None else int(archived),
                pseudonym,
            )
            return self.trainee(pseudonym)

    def delete_trainee(self, pseudonym: str) -> int:
        """Delete a trainee with all trials and results for good; return the number of trials.

        These trials are refused from now on. Only hashes of the random UUIDs are stored: without
        the record, no one can learn that a trial existed.
        """
        with self.database.writing():
            self.trainee(pseudonym)
            own = f"WHERE trainee_id = ({TRAINEE_ID})"
            finished, aborted, drills = (
                self.database.rows(f"SELECT trial_id FROM {table} {own}", pseudonym)
                for table in _RECORDS
            )
            for (trial_id,) in (*finished, *aborted, *drills):
                self.database.insert("deleted_trials", is_once=True, trial_sha256=_sha256(trial_id))
            self.database.change("DELETE FROM trainees WHERE pseudonym = ?", pseudonym)
        return len(finished)

    def add_trial(
        self,
        record: TrialRecord | Mapping[str, Any],
        registrations: Iterable[Registration] = (),
        target_errors: Mapping[str, TargetError] | None = None,
        score: TrialScore | None = None,
        delivered: Mapping[str, Any] | None = None,
        **others: Any,
    ) -> bool:
        """Store a finished trial with its results, if known; return whether it was new.

        A trial that is already stored is not changed, and `DeletedTrialError` is raised if it was
        deleted. An unknown trainee is added without consent, so that no trial is lost. The record
        may be an untrusted JSON object: then unknown keys are stored, too.
        `others` are further results, as of `add_results`.
        """
        if not isinstance(record, TrialRecord):
            delivered = record
            record = record_from_json(TrialRecord, delivered)
        with self.database.writing():
            if not self.is_new(record):
                return False
            self._store("trials", record, delivered)
            self.add_results(record.trial_id, registrations, target_errors, score, **others)
        return True

    def is_new(self, record: Delivered) -> bool:
        """Return whether a record would be new; refuse a deleted one, and another of its UUID."""
        trial_id = record.trial_id
        with self.database.reading():
            if self.is_deleted(trial_id):
                raise DeletedTrialError(
                    "The trial was deleted from the study with its trainee and is not stored again."
                )
            for table in ("trials",) if isinstance(record, TrialRecord) else _RECORDS:
                query = f"SELECT record_json FROM {table} WHERE trial_id = ?"
                row = self.database.row(query, trial_id)
                if row is None:
                    continue
                stored = decoded_record(_RECORDS[table], row[0])
                if _without_seed(stored) != _without_seed(record):
                    raise InputError(
                        f"Another trial is stored under the UUID {trial_id}; the stored one is "
                        "kept."
                    )
                return False
        json_checks.accepted(json_checks.pseudonym, record.trainee, "A pseudonym")
        return True

    def add_aborted(
        self, record: AbortedTrial | Mapping[str, Any], delivered: Mapping[str, Any] | None = None
    ) -> bool:
        """Store an aborted trial, as `add_trial`; of one in which nothing was done, its number."""
        if not isinstance(record, AbortedTrial):
            delivered = record
            record = record_from_json(AbortedTrial, delivered)
        with self.database.writing():
            if not self.is_new(record):
                return False
            if record.is_kept:
                self._store("aborted_trials", record, delivered)
            else:
                self._note_delivery(record)
        return record.is_kept

    def add_drill(self, record: DrillRecord, delivered: Mapping[str, Any] | None = None) -> bool:
        """Store a drill of decisions, as `add_trial`."""
        with self.database.writing():
            is_new = self.is_new(record)
            if is_new:
                self._store("drills", record, delivered)
        return is_new

    def has(self, table: str, trial_id: str) -> bool:
        query = f"SELECT 1 FROM {table} WHERE trial_id = ?"
        return self.database.row(query, trial_id) is not None

    def is_revealed(self, trial_id: str) -> bool:
        query = "SELECT 1 FROM results WHERE trial_id = ? AND kind = ?"
        return self.database.row(query, trial_id, TRUTH) is not None

    def is_deleted(self, trial_id: str) -> bool:
        query = "SELECT 1 FROM deleted_trials WHERE trial_sha256 = ?"
        return self.database.row(query, _sha256(trial_id)) is not None

    def _note_delivery(self, record: AbortedTrial | TrialRecord | DrillRecord) -> None:
        """Note that a trial has arrived; one without a number, from elsewhere, leaves no trace."""
        if record.number and record.series:
            self.database.insert(
                "deliveries", is_once=True, series=record.series, number=record.number
            )

    def _store(self, table: str, record: Delivered, delivered: Mapping[str, Any] | None) -> None:
        text = json_text(delivered or record_to_json(record))
        if len(text) > RECORD_LIMIT_BYTES:
            raise InputError("The trial record is larger than 1 MiB, the most that is stored.")
        self._note_delivery(record)
        if not self.has_trainee(record.trainee):
            self.create_trainee(record.trainee)
        found = {name: getattr(record, name, None) for name in TABLES[table].columns}
        columns = {
            name: value.value if isinstance(value, Enum) else value
            for name, value in found.items()
            if value is not None
        }
        self.database.insert(table, trainee=record.trainee, record_json=text, **columns)

    def undelivered(self) -> Mapping[str, tuple[tuple[int, int], ...]]:
        """Return the first and last numbers of each gap in what arrived, by series.

        A simulator numbers all trials that are started in its folder, so a gap is a trial that went
        to another study, that still waits there, or that somebody has made vanish.
        """
        query = "SELECT series, number FROM deliveries ORDER BY series, number"
        gaps = defaultdict(list)
        for (series, number), (same, following) in itertools.pairwise(self.database.rows(query)):
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
        truth: RevealedTruth | None = None,
    ) -> None:
        """Add results of a stored trial; the latest count, and of the truth the first.

        How far the skin had shifted is in the record, and not stored with the truth.
        """
        results: list[tuple[str, float, Any]] = [
            (fit.kind, fit.fre_mm, StoredRegistration.of(fit, (target_errors or {}).get(fit.kind)))
            for fit in registrations
        ]
        with self.database.writing():
            if not self.has("trials", trial_id):
                raise _no_trial(trial_id)
            if truth is not None and not self.is_revealed(trial_id):
                results.append((TRUTH, truth.true_tre_mm, replace(truth, skin=UNMOVED)))
            if score is not None:
                results.append((SCORE, score.score, score))
            if procedure is not None:
                results.append((PROCEDURE, procedure.score.score, procedure))
            for kind, value, result in results:
                # A score keeps its version, even the present one.
                text = json_text(record_to_json(result, with_defaults=kind in (SCORE, PROCEDURE)))
                self.database.insert(
                    "results", trial_id=trial_id, kind=kind, value=value, result_json=text
                )

    def record(self, trial_id: str) -> TrialRecord:
        row = self.database.row("SELECT record_json FROM trials WHERE trial_id = ?", trial_id)
        if row is None:
            raise _no_trial(trial_id)
        return decoded_record(TrialRecord, row[0])

    def trial(self, trial_id: str) -> StoredTrial:
        """Return a trial with its latest results; raise `InputError` if unknown."""
        with self.database.reading():
            record = self.record(trial_id)
            query = "SELECT kind, result_json FROM results WHERE trial_id = ? ORDER BY id"
            latest = dict(self.database.rows(query, trial_id))
        found = {kind: result_of(kind, text) for kind, text in latest.items()}
        score, procedure, truth = (found.pop(kind, None) for kind in RESULTS)
        return StoredTrial(record, found, score, truth, procedure)

    def history(self, pseudonym: str) -> tuple[StoredTrial, ...]:
        """Return all trials of a trainee in order of starting; unchanged trials are kept."""
        with self.database.reading():
            self.trainee(pseudonym)
            known = self._read_trials
            self._read_trials = {
                trial_id: known[trial_id]
                if trial_id in known and known[trial_id][0] == stamp
                else (stamp, self.trial(trial_id))
                for trial_id, *stamp in self.database.rows(_STAMPED_TRIALS, pseudonym)
            }
        return tuple(trial for _stamp, trial in self._read_trials.values())

    def aborted(self, pseudonym: str) -> tuple[AbortedTrial, ...]:
        """Return a trainee's aborted trials in order of starting; `InputError` if unknown."""
        with self.database.reading():
            self.trainee(pseudonym)
            rows = self.database.rows(
                "SELECT record_json, coalesce(step, ''), coalesce(reason, '') "
                "FROM aborted_trials LEFT JOIN repeats USING (trial_id) "
                f"WHERE trainee_id = ({TRAINEE_ID}) ORDER BY id",
                pseudonym,
            )
        found = [
            replace(decoded_record(AbortedTrial, text), step=step, repeat_reason=reason)
            for text, step, reason in rows
        ]
        return tuple(sorted(found, key=lambda record: moment(record.started_utc)))

    def drills(self, pseudonym: str) -> tuple[DrillRecord, ...]:
        """Return a trainee's drills in order of starting; raise `InputError` if unknown."""
        with self.database.reading():
            self.trainee(pseudonym)
            query = f"SELECT record_json FROM drills WHERE trainee_id = ({TRAINEE_ID}) ORDER BY id"
            rows = self.database.rows(query, pseudonym)
        found = [decoded_record(DrillRecord, text) for (text,) in rows]
        return tuple(sorted(found, key=lambda record: moment(record.started_utc)))

    def attempts(self, pseudonym: str) -> tuple[TrialRow, ...]:
        """Return the trials from which progress is computed, as started: scored and failed.

        Aborted trials with a touch have failed, and trials that can have no score, since their
        truth is known. Trial runs are left out.
        """
        with self.database.reading():
            aborted = self.aborted(pseudonym)
            rows = self.database.rows(_ATTEMPTS, pseudonym, TRIAL_RUN)
        found = []
        for *known, seconds, scored, done, true_mm in rows:
            if scored is None and true_mm is None:
                continue
            score = None if scored is None else result_of(SCORE, scored)
            values = {"completion_time_s": seconds}
            values |= {} if score is None else {"score": score.score}
            values |= {} if true_mm is None else {"true_tre_mm": true_mm}
            row = TrialRow(
                **dict(zip(_NAMES, known, strict=True)),
                values=values,
                acceptable=score is not None and score.acceptable,
                procedure=None if done is None else result_of(PROCEDURE, done),
                parts={} if score is None else score.parts,
                is_aborted=score is None,
            )
            found.append(row)
        found += [TrialRow.of(record) for record in aborted if record.counts_as_failed]
        return tuple(sorted(found, key=lambda trial: moment(trial.started_utc)))

    def unrevealed(self) -> tuple[TrialRecord, ...]:
        rows = self.database.rows(
            "SELECT record_json FROM trials WHERE trial_id NOT IN "
            "(SELECT trial_id FROM results WHERE kind = ?) ORDER BY id",
            TRUTH,
        )
        return tuple(decoded_record(TrialRecord, text) for (text,) in rows)

    def outcomes(self, task: str, mode: str) -> list[TrialRow]:
        """Return the time, latest score and true error of all trials of a task and mode."""
        rows = []
        for trial_id, trainee, method, *found in self.database.rows(_OUTCOMES, task, mode):
            known = zip(("completion_time_s", "score", "true_tre_mm"), found, strict=True)
            values = {name: value for name, value in known if value is not None}
            row = TrialRow(trainee, mode, task, values=values, trial_id=trial_id, method=method)
            rows.append(row)
        return rows


def _trainee(pseudonym: str, consent: int, archived: int, created_utc: str) -> Trainee:
    return Trainee(pseudonym, bool(consent), bool(archived), created_utc)


def _no_trial(trial_id: str) -> InputError:
    return InputError(f"The study has no trial {json.dumps(str(trial_id)[:64])}.")


def _without_seed(record: object) -> object:
    """Return a record without the seed, a secret of the simulator that may be revealed later."""
    return replace(record, seed=None) if isinstance(record, TrialRecord) else record


def _sha256(trial_id: str) -> str:
    return hashlib.sha256(trial_id.encode()).hexdigest()
