"""Trials in a study's database; each function runs in the caller's transaction, see `Study`."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, TypeVar

from rastrainer import json_checks, protocol
from rastrainer.errors import InputError
from rastrainer.json_checks import decode_finite_json
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.fits import RIGID
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.study.database import deliveries, study_trainees
from rastrainer.study.database.database import Connection, Rows
from rastrainer.study.database.study_trainees import TRAINEE_ID, check_not_deleted
from rastrainer.study.database.values import (
    StoredProcedure,
    StoredRegistration,
    StoredTrial,
    TrialOutcome,
    utc_now,
)
from rastrainer.trial.ctps import Trial
from rastrainer.trial.procedure_outcome import ProcedureOutcome
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import TrialScore
from rastrainer.trial.trial_feedback import PastTrial

RECORD_LIMIT_BYTES = 2**20
TRUTH_LIMIT = 1e6
MOTION_LIMIT = 1e9

_LATEST_SCORE = """
    SELECT {} FROM scores WHERE scores.trial_id = trials.trial_id ORDER BY scores.id DESC LIMIT 1
"""

METHOD = "coalesce(json_extract(record_json, '$.method'), 'fiducials')"
"""By what a trial was registered: its record names only other methods than fiducials."""

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

_NULL = re.compile(r"(?<!\\)(?:\\\\)*\\u0000")
Value = TypeVar("Value")


def add(connection: Connection, record: TrialRecord, json_object: Mapping[str, Any]) -> bool:
    """Store a trial with its trainee; return False if it is stored already."""
    text = record_text(json_object)
    if not check(connection, record):
        return False
    deliveries.note(connection, record)
    study_trainees.create_where_missing(connection, record.trainee, consent=False)
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
        set_motion(connection, record.trial_id, record.motion)
    return True


def check(connection: Connection, record: TrialRecord) -> bool:
    """Return whether a trial would be new."""
    check_not_deleted(connection, record.trial_id)
    if exists(connection, record.trial_id):
        _check_same(find_record(connection, record.trial_id), record)
        return False
    if not study_trainees.exists(connection, record.trainee):
        study_trainees.check_pseudonym(record.trainee)
    return True


def add_results(
    connection: Connection,
    trial_id: str,
    registrations: Iterable[Registration],
    target_errors: Mapping[str, TargetError],
    score: TrialScore | None,
    procedure: ProcedureOutcome | None = None,
) -> None:
    """Add results that were computed from a trial."""
    _check_exists(connection, trial_id)
    for registration in registrations:
        stored = StoredRegistration.of(registration, target_errors.get(registration.kind))
        connection.execute(
            "INSERT INTO registrations (trial_id, kind, fre_mm, registration_json, stored_utc) "
            "VALUES (?, ?, ?, ?, ?)",
            (trial_id, stored.kind, stored.fre_mm, json_text(stored.to_json()), utc_now()),
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
        stored_outcome = json_text(StoredProcedure.of(procedure).to_json())
        of_procedure = procedure.score
        connection.execute(
            "INSERT INTO procedure_outcomes (trial_id, score, version, outcome_json, stored_utc) "
            "VALUES (?, ?, ?, ?, ?)",
            (trial_id, of_procedure.score, of_procedure.version, stored_outcome, utc_now()),
        )


def set_truth(
    connection: Connection,
    trial_id: str,
    true_tre_mm: float,
    head_to_world: Sequence[float],
) -> None:
    """Store the truth that the simulator revealed; only the first one counts."""
    _check_exists(connection, trial_id)
    try:
        true_tre_mm = json_checks.number(0, TRUTH_LIMIT)(true_tre_mm)
        head_to_world = json_checks.numbers(16, TRUTH_LIMIT)(head_to_world)
    except ValueError as error:
        raise InputError(f"What the simulator reveals must be {error}.") from None
    connection.execute(
        "INSERT INTO truths VALUES (?, ?, ?, ?) ON CONFLICT DO NOTHING",
        (trial_id, true_tre_mm, json_text(head_to_world), utc_now()),
    )


def set_motion(connection: Connection, trial_id: str, motion: Mapping[str, float]) -> None:
    """Store the motion metrics of a trial; only the first ones count."""
    _check_exists(connection, trial_id)
    try:
        checked = {
            json_checks.text()(name): json_checks.number(-MOTION_LIMIT, MOTION_LIMIT)(value)
            for name, value in motion.items()
        }
    except ValueError as error:
        raise InputError(f"A motion metric must be {error}.") from None
    connection.execute(
        "INSERT INTO motions VALUES (?, ?, ?) ON CONFLICT DO NOTHING",
        (trial_id, json_text(checked), utc_now()),
    )


def exists(connection: Connection, trial_id: str) -> bool:
    query = "SELECT 1 FROM trials WHERE trial_id = ?"
    return connection.execute(query, (trial_id,)).fetchone() is not None


def is_revealed(connection: Connection, trial_id: str) -> bool:
    query = "SELECT 1 FROM truths WHERE trial_id = ?"
    return connection.execute(query, (trial_id,)).fetchone() is not None


def find_record(connection: Connection, trial_id: str) -> TrialRecord:
    """Return the record of a trial."""
    _check_exists(connection, trial_id)
    (text,) = connection.execute(
        "SELECT record_json FROM trials WHERE trial_id = ?", (trial_id,)
    ).fetchone()
    return decoded(text, partial(record_from_json, TrialRecord))


def find(connection: Connection, trial_id: str) -> StoredTrial:
    """Return a trial with its latest results."""
    record = find_record(connection, trial_id)

    def rows(columns: str, table: str, order: str = "") -> Rows:
        query = f"SELECT {columns} FROM {table} WHERE trial_id = ? {order}"
        return connection.execute(query, (trial_id,))

    registrations = rows("kind, registration_json", "registrations", "ORDER BY id").fetchall()
    score = rows("score_json", "scores", "ORDER BY id DESC").fetchone()
    truth = rows("true_tre_mm, head_to_world_json", "truths").fetchone()
    motion = rows("motion_json", "motions").fetchone()
    procedure = rows("outcome_json", "procedure_outcomes", "ORDER BY id DESC").fetchone()
    return StoredTrial(
        record=record,
        registrations={
            kind: decoded(text, StoredRegistration.from_json) for kind, text in registrations
        },
        score=None if score is None else decoded(score[0], partial(record_from_json, TrialScore)),
        true_tre_mm=None if truth is None else truth[0],
        head_to_world=None if truth is None else decoded(truth[1], tuple),
        motion={} if motion is None else decoded(motion[0], dict),
        procedure=None if procedure is None else decoded(procedure[0], StoredProcedure.from_json),
    )


def history(
    connection: Connection, pseudonym: str, known: dict[str, tuple[tuple, StoredTrial]]
) -> tuple[StoredTrial, ...]:
    """Return a trainee's trials in order of starting.

    `known` caches trials with a stamp that changes with them; it is updated to this trainee's.
    """
    study_trainees.find(connection, pseudonym)
    rows = connection.execute(_STAMPED_TRIALS, (pseudonym,)).fetchall()
    read = {
        trial_id: known[trial_id]
        if trial_id in known and known[trial_id][0] == tuple(stamp)
        else (tuple(stamp), find(connection, trial_id))
        for trial_id, *stamp in rows
    }
    known.clear()
    known.update(read)
    return tuple(trial for _stamp, trial in read.values())


def past_trials(connection: Connection, pseudonym: str) -> tuple[PastTrial, ...]:
    """Return a trainee's scored trials without trial runs, in order of starting."""
    study_trainees.find(connection, pseudonym)
    rows = connection.execute(
        "SELECT trial_id, task, mode, completion_time_s, method, latest FROM ("
        "SELECT trial_id, task, mode, completion_time_s, started_utc, trials.rowid AS stored, "
        f"{METHOD} AS method, ({_LATEST_SCORE.format('score_json')}) AS latest "
        f"FROM trials WHERE trainee_id = ({TRAINEE_ID}) AND task != ?"
        ") AS played WHERE latest IS NOT NULL ORDER BY started_utc, stored",
        (pseudonym, protocol.TRIAL_RUN),
    )
    # Row by row, so that not all records are in memory together.
    return tuple(_past_trial(*row) for row in rows)


def _past_trial(
    trial_id: str, task: str, mode: str, seconds: float, method: str, latest: str
) -> PastTrial:
    score = decoded(latest, partial(record_from_json, TrialScore))
    return PastTrial(
        trial_id,
        task,
        mode,
        seconds,
        score.score,
        score.acceptable,
        method=RegistrationMethod(method),
    )


def unscored(connection: Connection, pseudonym: str) -> tuple[TrialRecord, ...]:
    """Return a trainee's trials that have no score although their truth is known: none will come.

    Trial runs are left out.
    """
    rows = connection.execute(
        f"SELECT record_json FROM trials WHERE trainee_id = ({TRAINEE_ID}) AND task != ? "
        "AND trial_id IN (SELECT trial_id FROM truths) "
        "AND trial_id NOT IN (SELECT trial_id FROM scores)",
        (pseudonym, protocol.TRIAL_RUN),
    ).fetchall()
    return tuple(decoded(text, partial(record_from_json, TrialRecord)) for (text,) in rows)


def unrevealed(connection: Connection) -> tuple[TrialRecord, ...]:
    """Return the records of trials without stored truth, oldest first."""
    rows = connection.execute(
        "SELECT record_json FROM trials "
        "WHERE trial_id NOT IN (SELECT trial_id FROM truths) ORDER BY rowid"
    ).fetchall()
    return tuple(decoded(text, partial(record_from_json, TrialRecord)) for (text,) in rows)


def cohort(connection: Connection, mode: str | None) -> list[Trial]:
    """Return the registered trials without trial runs, for CTPS."""
    rows = connection.execute(
        """
        SELECT mode, pseudonym, task, completion_time_s, fre_mm
        FROM trials
        JOIN trainees ON trainees.id = trainee_id
        JOIN registrations ON registrations.id = (
            SELECT max(id) FROM registrations AS latest
            WHERE latest.trial_id = trials.trial_id AND kind = ?
        )
        WHERE task != ? AND mode = coalesce(?, mode)
        ORDER BY trials.rowid
        """,
        (RIGID, protocol.TRIAL_RUN, mode),
    ).fetchall()
    return [Trial(*row) for row in rows]


def outcomes(connection: Connection, task: str, mode: str) -> tuple[TrialOutcome, ...]:
    """Return the outcomes of all trials of a task and mode, in order of storing."""
    rows = connection.execute(
        f"""
        SELECT trials.trial_id, pseudonym, completion_time_s,
            ({_LATEST_SCORE.format("score")}), {METHOD}, true_tre_mm
        FROM trials
        JOIN trainees ON trainees.id = trainee_id
        LEFT JOIN truths ON truths.trial_id = trials.trial_id
        WHERE task = ? AND mode = ?
        ORDER BY trials.rowid
        """,
        (task, mode),
    ).fetchall()
    return tuple(TrialOutcome(*row) for row in rows)


def json_text(value: object) -> str:
    """Return a value as ASCII JSON; raise `InputError` if that is impossible.

    Null characters and halves of surrogate pairs are refused: PostgreSQL cannot read JSON with
    them, and a single trial would hide all of its trainee's.
    """
    try:
        text = json.dumps(value, allow_nan=False)
        if "\\ud" in text:
            json.dumps(value, ensure_ascii=False).encode()
        if _NULL.search(text):
            raise ValueError
    except (TypeError, ValueError, RecursionError):
        raise InputError(
            "What a study stores must be JSON with finite numbers and whole characters, none of "
            "them null."
        ) from None
    return text


def record_text(record: Mapping[str, Any]) -> str:
    """Return a record as ASCII JSON; raise `InputError` if that is impossible or above 1 MiB."""
    text = json_text(record)
    if len(text) > RECORD_LIMIT_BYTES:
        raise InputError("The trial record is larger than 1 MiB, the most that is stored.")
    return text


def decoded(text: str, read: Callable[[Any], Value]) -> Value:
    """Return decoded stored JSON; raise `InputError` if it is invalid."""
    try:
        return read(decode_finite_json(text))
    except (TypeError, ValueError, KeyError, AttributeError):
        raise InputError("The study contains a value that RASTrainer did not write.") from None


def _check_exists(connection: Connection, trial_id: str) -> None:
    if not exists(connection, trial_id):
        raise InputError(f"The study has no trial {json.dumps(str(trial_id)[:64])}.")


def _check_same(stored: TrialRecord, delivered: TrialRecord) -> None:
    # The seed is the simulator's secret at first and may be revealed later.
    if replace(stored, seed=None) != replace(delivered, seed=None):
        raise InputError(
            f"Another trial is stored under the UUID {stored.trial_id}; the stored one is kept."
        )
