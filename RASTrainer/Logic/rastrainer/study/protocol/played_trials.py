"""The stored trials that belong to the next steps; functions run in the caller's transaction.

A trial, finished or aborted, belongs to a step if it was started after enrollment and after the
last counted trial.
"""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime
from typing import Any

from rastrainer.protocol import RegistrationMethod
from rastrainer.study.database.aborted_trials import unexplained
from rastrainer.study.database.database import Connection
from rastrainer.study.database.study_trainees import TRAINEE_ID
from rastrainer.study.database.study_trials import decoded
from rastrainer.study.database.values import moment
from rastrainer.study.protocol.progress import DONE, Progress, StepEntry
from rastrainer.study.protocol.steps import Step, StepKind
from rastrainer.trial.aborted_trial import AbortedTrial


def played_next(connection: Connection, pseudonym: str, progress: Progress) -> list[StepEntry]:
    """Return the entries of next steps whose trials are stored but not counted yet."""
    entries = []
    while (step := progress.next_step) is not None:
        found = _played_for(connection, pseudonym, progress, step)
        if found is None:
            break
        (stored_utc,) = connection.execute(
            "SELECT stored_utc FROM trials WHERE trial_id = ?", (found,)
        ).fetchone()
        entry = StepEntry(step.name, DONE, {"trialId": found}, stored_utc)
        entries.append(entry)
        progress = replace(progress, entries=(*progress.entries, entry))
    return entries


def _played_for(
    connection: Connection, pseudonym: str, progress: Progress, step: Step
) -> str | None:
    """Return the UUID of the next step's trial, or None; a repeat needs a reason to count."""
    counted = set(progress.counted_trials)
    if step.kind is not StepKind.TRIAL:
        return None
    since = _since(connection, pseudonym, progress)
    found = next(
        (
            (when, trial)
            for when, trial, *played, shift, indentation in _trials_of(connection, pseudonym)
            if played == [step.mode, step.task, step.procedure, step.method]
            and step.is_played_on(shift, indentation)
            and trial not in counted
            and when >= since
        ),
        None,
    )
    if found is None:
        return None
    aborted = aborted_before(connection, pseudonym, progress)
    is_repeat = any(moment(record.started_utc) <= found[0] for record in aborted)
    return None if is_repeat else found[1]


def _trials_of(connection: Connection, pseudonym: str) -> list[tuple[Any, ...]]:
    """Return a trainee's finished trials, in order.

    Each is its start, UUID, mode, task, procedure and method, and how far its skin had shifted and
    was indented, mm.
    """
    rows = connection.execute(
        "SELECT started_utc, trial_id, mode, task, "
        "coalesce(json_extract(record_json, '$.procedure.procedure'), ''), "
        "coalesce(json_extract(record_json, '$.method'), ?), "
        "coalesce(json_extract(record_json, '$.skin.shiftMm'), ''), "
        "coalesce(json_extract(record_json, '$.skin.indentationMm'), '') "
        f"FROM trials WHERE trainee_id = ({TRAINEE_ID})",
        (RegistrationMethod.FIDUCIALS.value, pseudonym),
    ).fetchall()
    return sorted(
        (moment(started), *others, _number(shift), _number(indentation))
        for started, *others, shift, indentation in rows
    )


def _number(extracted: object) -> float:
    """Return a number of a record, 0 where it has none."""
    return decoded(str(extracted or 0), float)


def _since(connection: Connection, pseudonym: str, progress: Progress) -> datetime:
    """Return the earliest start of the next step's trial."""
    counted = set(progress.counted_trials)
    after = [when for when, trial, *_ in _trials_of(connection, pseudonym) if trial in counted]
    return max([*after, moment(progress.enrolled_utc)])


def aborted_before(
    connection: Connection, pseudonym: str, progress: Progress
) -> tuple[AbortedTrial, ...]:
    """Return the aborted trials of the next step without a reason."""
    step = progress.next_step
    if step is None or step.kind is not StepKind.TRIAL:
        return ()
    # Skipping a step settles its aborted trials.
    left_out = [moment(entry.stored_utc) for entry in progress.skipped]
    since = max([_since(connection, pseudonym, progress), *left_out])
    return unexplained(connection, pseudonym, step.mode, step.task, since)
