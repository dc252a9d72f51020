"""A study's protocol and every trainee's progress, stored in the study's file.

The module in Slicer and the simulator's flow ask `progress` for the next step and report completed
ones. Everything is stored before it is reported, so it survives interruptions.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from rastrainer.errors import InputError
from rastrainer.study.database import study_trainees, study_trials
from rastrainer.study.database.aborted_trials import explain
from rastrainer.study.database.database import Connection
from rastrainer.study.database.study import Study
from rastrainer.study.database.study_trainees import TRAINEE_ID
from rastrainer.study.database.study_trials import decoded, json_text
from rastrainer.study.database.values import utc_now
from rastrainer.study.protocol.questionnaires import find_questionnaire
from rastrainer.study.protocol.step_progress import (
    DONE,
    SKIPPED,
    StepEntry,
    StepProgress,
    aborted_before,
    played_next,
)
from rastrainer.study.protocol.steps import Step, StepKind, steps_for
from rastrainer.study.protocol.study_protocol import StudyProtocol, study_protocol_from_json


@dataclass(frozen=True)
class QuestionnaireAnswers:
    """The answers of a trainee, and their scores."""

    trainee: str
    step: Step
    answers: tuple[int, ...]
    scores: Mapping[str, float]
    stored_utc: str


class StudyProgress:
    """A study's protocol and the progress of its trainees. For one thread."""

    def __init__(self, study: Study) -> None:
        self._database = study.database

    def set_protocol(self, protocol: StudyProtocol) -> None:
        """Set the study's protocol; the same one again changes nothing."""
        with self._database.writing() as connection:
            stored = _protocol(connection)
            if stored is None:
                text = json_text(protocol.to_json())
                connection.execute("INSERT INTO study_protocol VALUES (1, ?, ?)", (text, utc_now()))
            elif stored != protocol:
                raise InputError(
                    f"This study was started with another protocol, {stored.title!r}. Changing it "
                    "midway would invalidate the study: start a new one for the new protocol."
                )

    def protocol(self) -> StudyProtocol | None:
        """Return the study's protocol, or None if trainees practice freely."""
        with self._database.reading() as connection:
            return _protocol(connection)

    def enroll(self, pseudonym: str) -> int:
        """Return a trainee's place, the first free one if not enrolled yet.

        The place determines the order of modes and tasks. The place of a deleted trainee is reused,
        so the orders stay balanced.
        """
        with self._database.writing() as connection:
            _require_protocol(connection)
            study_trainees.find(connection, pseudonym)
            place = _place(connection, pseudonym)
            if place is None:
                taken = {row[0] for row in connection.execute("SELECT place FROM enrollments")}
                place = next(number for number in range(len(taken) + 1) if number not in taken)
                connection.execute(
                    f"INSERT INTO enrollments VALUES (({TRAINEE_ID}), ?, ?)",
                    (pseudonym, place, utc_now()),
                )
            return place

    def progress(self, pseudonym: str) -> StepProgress:
        """Return the progress of a trainee."""
        with self._database.reading() as connection:
            return _progress(connection, pseudonym)

    def finish(
        self, pseudonym: str, step: str, details: Mapping[str, Any] | None = None
    ) -> StepProgress:
        """Store that the next step was done and return the new progress.

        Args:
            pseudonym: Of an enrolled trainee.
            step: Name of the next step.
            details: `trialId` of a stored trial, `answers` of a questionnaire, or `minutes` of a
                trial run or break.
        """
        with self._database.writing() as connection:
            progress = _progress(connection, pseudonym)
            expected = progress.expected(step)
            checked = progress.check_done(expected, details or {})
            if expected.kind is StepKind.TRIAL:
                _check_trial(connection, pseudonym, progress, expected, checked["trialId"])
            _store(connection, pseudonym, step, DONE, checked)
            return _progress(connection, pseudonym)

    def skip(self, pseudonym: str, step: str, reason: str) -> StepProgress:
        """Skip the next step for a reason and return the new progress."""
        with self._database.writing() as connection:
            checked = _progress(connection, pseudonym).check_skipped(step, reason)
            _store(connection, pseudonym, step, SKIPPED, checked)
            return _progress(connection, pseudonym)

    def explain_repeat(self, pseudonym: str, reason: str) -> StepProgress:
        """Store why the next step is repeated after an abort; return the new progress."""
        with self._database.writing() as connection:
            progress = _progress(connection, pseudonym)
            step, checked = progress.check_repeat(reason)
            for record in progress.unexplained:
                explain(connection, record.trial_id, step.name, checked)
            return _progress(connection, pseudonym)

    def practice(self, pseudonym: str, step: str, seconds: float) -> None:
        """Add to the practiced time of the next step, a trial run."""
        with self._database.writing() as connection:
            next_step = _progress(connection, pseudonym).next_step
            if (
                next_step is None
                or next_step.name != step
                or next_step.kind is not StepKind.TRIAL_RUN
            ):
                raise InputError(f"{step[:80]} is not the next step, or not a trial run.")
            connection.execute(
                f"INSERT INTO practice VALUES (({TRAINEE_ID}), ?, ?) "
                "ON CONFLICT (trainee_id, step) "
                "DO UPDATE SET seconds = practice.seconds + excluded.seconds",
                (pseudonym, step, float(seconds)),
            )

    def count_played(self, pseudonym: str) -> StepProgress:
        """Count stored trials for the next steps, and return the new progress.

        Trials count if started after enrollment and after the last counted trial, also if they
        arrive late or an interruption left their step open. A repeat counts once its reason is
        given.
        """
        with self._database.reading() as connection:
            progress = _progress(connection, pseudonym)
            if not played_next(connection, pseudonym, progress):
                return progress
        with self._database.writing() as connection:
            progress = _progress(connection, pseudonym)
            for entry in played_next(connection, pseudonym, progress):
                _store(connection, pseudonym, entry.step, entry.outcome, dict(entry.details))
            return _progress(connection, pseudonym)

    def played(self, pseudonym: str) -> StepProgress:
        """Return the progress that `count_played` would give, without storing it."""
        with self._database.reading() as connection:
            progress = _progress(connection, pseudonym)
            further = played_next(connection, pseudonym, progress)
            entries = (*progress.entries, *further)
            if not further:
                return progress
            progress = replace(progress, entries=entries)
            return replace(progress, unexplained=aborted_before(connection, pseudonym, progress))

    def enrolled(self) -> dict[str, int]:
        """Return the place of each enrolled trainee, in order."""
        with self._database.reading() as connection:
            return dict(
                connection.execute(
                    "SELECT pseudonym, place FROM enrollments "
                    "JOIN trainees ON trainees.id = trainee_id ORDER BY place"
                ).fetchall()
            )

    def answers(self) -> tuple[QuestionnaireAnswers, ...]:
        """Return all answered questionnaires, by place and step."""
        return tuple(
            answered
            for pseudonym in self.enrolled()
            for answered in _answers(pseudonym, self.progress(pseudonym))
        )


def _answers(pseudonym: str, progress: StepProgress) -> list[QuestionnaireAnswers]:
    found = []
    for step, entry in zip(progress.steps, progress.entries, strict=False):
        if step.kind is StepKind.QUESTIONNAIRE and entry.outcome == DONE:
            answers = tuple(entry.details["answers"])
            scores = find_questionnaire(step.questionnaire).score(answers)
            found.append(QuestionnaireAnswers(pseudonym, step, answers, scores, entry.stored_utc))
    return found


def _progress(connection: Connection, pseudonym: str) -> StepProgress:
    protocol = _require_protocol(connection)
    place = _place(connection, pseudonym)
    if place is None:
        raise InputError(f"{json.dumps(str(pseudonym)[:64])} is not enrolled in the study yet.")
    (enrolled_utc,) = connection.execute(
        f"SELECT stored_utc FROM enrollments WHERE trainee_id = ({TRAINEE_ID})", (pseudonym,)
    ).fetchone()
    rows = connection.execute(
        "SELECT step, outcome, details_json, stored_utc FROM steps "
        f"WHERE trainee_id = ({TRAINEE_ID}) ORDER BY id",
        (pseudonym,),
    ).fetchall()
    entries = [
        StepEntry(step, outcome, decoded(details, dict), utc)
        for step, outcome, details, utc in rows
    ]
    progress = StepProgress.of(steps_for(protocol, place), entries, enrolled_utc)
    return replace(
        progress,
        practiced_s=_practiced(connection, pseudonym, progress.next_step),
        unexplained=aborted_before(connection, pseudonym, progress),
    )


def _practiced(connection: Connection, pseudonym: str, step: Step | None) -> float:
    row = connection.execute(
        f"SELECT seconds FROM practice WHERE trainee_id = ({TRAINEE_ID}) AND step = ?",
        (pseudonym, "" if step is None else step.name),
    ).fetchone()
    return 0.0 if row is None else row[0]


def _protocol(connection: Connection) -> StudyProtocol | None:
    row = connection.execute("SELECT protocol_json FROM study_protocol").fetchone()
    return None if row is None else decoded(row[0], study_protocol_from_json)


def _require_protocol(connection: Connection) -> StudyProtocol:
    protocol = _protocol(connection)
    if protocol is None:
        raise InputError("The study has no protocol yet; start it with a protocol file.")
    return protocol


def _place(connection: Connection, pseudonym: str) -> int | None:
    row = connection.execute(
        f"SELECT place FROM enrollments WHERE trainee_id = ({TRAINEE_ID})", (pseudonym,)
    ).fetchone()
    return None if row is None else row[0]


def _check_trial(
    connection: Connection, pseudonym: str, progress: StepProgress, step: Step, trial_id: str
) -> None:
    record = study_trials.find_record(connection, trial_id)
    played = (record.trainee, record.mode, record.task, record.method.value)
    if played != (pseudonym, step.mode, step.task, step.method):
        raise InputError(
            f"The trial {trial_id} is not the one that the step {step.name} asks for: it was "
            f"{record.task} in the mode {record.mode}, registered by {record.method.value}."
        )
    skin = record.skin
    if not step.is_played_on(skin.shift_mm, skin.indentation_mm):
        raise InputError(
            f"The trial {trial_id} is not the one that the step {step.name} asks for: its skin had "
            f"shifted by {skin.shift_mm:g} mm and was indented by {skin.indentation_mm:g} mm."
        )
    if objections := step.objections(record):
        raise InputError(
            f"The trial {trial_id} does not count for the step {step.name}: "
            f"{'; '.join(objections)}."
        )
    if any(entry.details.get("trialId") == trial_id for entry in progress.entries):
        raise InputError(f"The trial {trial_id} already counts for an earlier step.")


def _store(
    connection: Connection, pseudonym: str, step: str, outcome: str, details: dict[str, Any]
) -> None:
    connection.execute(
        "INSERT INTO steps (trainee_id, step, outcome, details_json, stored_utc) "
        f"VALUES (({TRAINEE_ID}), ?, ?, ?, ?)",
        (pseudonym, step, outcome, json_text(details), utc_now()),
    )
