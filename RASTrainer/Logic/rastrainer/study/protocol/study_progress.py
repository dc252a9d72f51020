"""A study's protocol and every trainee's progress, stored in the study's file.

The module in Slicer and the simulator's flow ask `progress` for the next step and report completed
steps. Everything is stored before it is reported, so it survives interruptions.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import datetime
from typing import Any

from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError
from rastrainer.protocol import StepKind
from rastrainer.study.database.schema import TRAINEE_ID
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import TRUTH, decoded, decoded_record, json_text, moment
from rastrainer.study.protocol import steps
from rastrainer.study.protocol.questionnaires import find_questionnaire
from rastrainer.study.protocol.study_protocol import StudyProtocol, steps_for
from rastrainer.study_messages import StudyStep
from rastrainer.trial.record import AbortedTrial, TrialRecord


@dataclass(frozen=True)
class QuestionnaireAnswers:
    """The answers of a trainee, and their scores."""

    trainee: str
    step: StudyStep
    answers: tuple[int, ...]
    scores: Mapping[str, float]
    stored_utc: str


class StudyProgress:
    """A study's protocol and the progress of its trainees. For one thread.

    A trial, finished or aborted, belongs to a step if it was started after enrollment and after the
    last counted trial.
    """

    def __init__(self, study: Study) -> None:
        self._study, self._database = study, study.database

    def set_protocol(self, protocol: StudyProtocol) -> None:
        with self._database.writing():
            stored = self.protocol()
            if stored is None:
                text = json_text(protocol.to_json())
                self._database.insert("study_protocol", id=1, protocol_json=text)
            elif stored != protocol:
                raise InputError(
                    f"This study was started with another protocol, {stored.title!r}. Changing it "
                    "midway would invalidate the study: start a new one for the new protocol."
                )

    def protocol(self) -> StudyProtocol | None:
        row = self._database.row("SELECT protocol_json FROM study_protocol")
        return None if row is None else decoded(row[0], StudyProtocol.from_json)

    def _require_protocol(self) -> StudyProtocol:
        protocol = self.protocol()
        if protocol is None:
            raise InputError("The study has no protocol yet; start it with a protocol file.")
        return protocol

    def enroll(self, pseudonym: str) -> int:
        """Return a trainee's place, the first free one if not enrolled yet.

        The place determines the order of modes and tasks. The place of a deleted trainee is reused,
        so the orders stay balanced.
        """
        with self._database.writing():
            self._require_protocol()
            self._study.trainee(pseudonym)
            places = self.enrolled()
            if pseudonym in places:
                return places[pseudonym]
            taken = places.values()
            place = next(number for number in range(len(taken) + 1) if number not in taken)
            self._database.insert("enrollments", trainee=pseudonym, place=place)
            return place

    def enrolled(self) -> dict[str, int]:
        return dict(
            self._database.rows(
                "SELECT pseudonym, place FROM enrollments "
                "JOIN trainees ON trainees.id = trainee_id ORDER BY place"
            )
        )

    def progress(self, pseudonym: str) -> steps.StepProgress:
        with self._database.reading():
            protocol = self._require_protocol()
            enrolled = self._database.row(
                f"SELECT place, stored_utc FROM enrollments WHERE trainee_id = ({TRAINEE_ID})",
                pseudonym,
            )
            if enrolled is None:
                who = json.dumps(str(pseudonym)[:64])
                raise InputError(f"{who} is not enrolled in the study yet.")
            place, enrolled_utc = enrolled
            rows = self._database.rows(
                "SELECT step, outcome, details_json, stored_utc FROM steps "
                f"WHERE trainee_id = ({TRAINEE_ID}) ORDER BY id",
                pseudonym,
            )
            entries = tuple(
                steps.StepEntry(step, outcome, decoded(details, dict), utc)
                for step, outcome, details, utc in rows
            )
            progress = steps.StepProgress(steps_for(protocol, place), entries, enrolled_utc)
            step = progress.next_step
            practiced = self._database.row(
                f"SELECT seconds FROM practice WHERE trainee_id = ({TRAINEE_ID}) AND step = ?",
                pseudonym,
                "" if step is None else step.name,
            )
            return replace(
                progress,
                practiced_s=0.0 if practiced is None else practiced[0],
                unexplained=self._aborted_before(pseudonym, progress),
            )

    def finish(
        self, pseudonym: str, step: str, details: Mapping[str, Any] | None = None
    ) -> steps.StepProgress:
        with self._database.writing():
            due = self.progress(pseudonym).due(step)
            checked = steps.checked_details(due, details or {})
            return self._store(pseudonym, step, steps.DONE, checked)

    def skip(self, pseudonym: str, step: str, reason: str) -> steps.StepProgress:
        with self._database.writing():
            self.progress(pseudonym).due(step)
            checked = steps.checked_reason(reason, "A step can be skipped")
            return self._store(pseudonym, step, steps.SKIPPED, {"reason": checked})

    def _store(
        self, pseudonym: str, step: str, outcome: str, details: Mapping[str, Any]
    ) -> steps.StepProgress:
        text = json_text(dict(details))
        self._database.insert(
            "steps", trainee=pseudonym, step=step, outcome=outcome, details_json=text
        )
        return self.progress(pseudonym)

    def explain_repeat(self, pseudonym: str, reason: str) -> steps.StepProgress:
        with self._database.writing():
            progress = self.progress(pseudonym)
            if not progress.unexplained:
                raise InputError("The next step was not aborted; it needs no reason to be played.")
            step = progress.due()
            checked = steps.checked_reason(reason, "An aborted trial can be repeated")
            for record in progress.unexplained:
                self._database.insert(
                    "repeats", trial_id=record.trial_id, step=step.name, reason=checked
                )
            return self.progress(pseudonym)

    def practice(self, pseudonym: str, step: str, seconds: float) -> None:
        with self._database.writing():
            due = self.progress(pseudonym).next_step
            if due is None or (due.name, due.kind) != (step, StepKind.TRIAL_RUN):
                raise InputError(f"{step[:80]} is not the next step, or not a trial run.")
            self._database.change(
                f"INSERT INTO practice VALUES (({TRAINEE_ID}), ?, ?) "
                "ON CONFLICT (trainee_id, step) "
                "DO UPDATE SET seconds = practice.seconds + excluded.seconds",
                pseudonym,
                step,
                float(seconds),
            )

    def count_played(self, pseudonym: str) -> steps.StepProgress:
        """Count stored trials for the next steps, and return the new progress.

        Trials count also if they arrive late or an interruption left their step open. A repeat
        counts once its reason is given.
        """
        with self._database.reading():
            progress = self.progress(pseudonym)
            if not self._played_next(pseudonym, progress):
                return progress
        with self._database.writing():
            progress = self.progress(pseudonym)
            for entry in self._played_next(pseudonym, progress):
                progress = self._store(pseudonym, entry.step, entry.outcome, entry.details)
            return progress

    def played(self, pseudonym: str) -> steps.StepProgress:
        """Return the progress that `count_played` would give, without storing it."""
        with self._database.reading():
            progress = self.progress(pseudonym)
            further = self._played_next(pseudonym, progress)
            if not further:
                return progress
            progress = replace(progress, entries=(*progress.entries, *further))
            return replace(progress, unexplained=self._aborted_before(pseudonym, progress))

    def answers(self) -> tuple[QuestionnaireAnswers, ...]:
        found = []
        for name in self.enrolled():
            progress = self.progress(name)
            for step, entry in zip(progress.steps, progress.entries, strict=False):
                if step.kind == StepKind.QUESTIONNAIRE and entry.outcome == steps.DONE:
                    given = tuple(entry.details["answers"])
                    scores = find_questionnaire(step.questionnaire).score(given)
                    utc = entry.stored_utc
                    found.append(QuestionnaireAnswers(name, step, given, scores, utc))
        return tuple(found)

    def _played_next(self, pseudonym: str, progress: steps.StepProgress) -> list[steps.StepEntry]:
        entries = []
        while (step := progress.next_step) is not None:
            found = self._played_for(pseudonym, progress, step)
            if found is None:
                break
            entries.append(found)
            progress = replace(progress, entries=(*progress.entries, found))
        return entries

    def _played_for(
        self, pseudonym: str, progress: steps.StepProgress, step: StudyStep
    ) -> steps.StepEntry | None:
        """Return the entry of the next step's trial or drill, or None; a repeat needs a reason."""
        columns = "SELECT started_utc, trial_id, stored_utc, record_json"
        kind: type[TrialRecord | DrillRecord]
        if step.kind == StepKind.TRIAL:
            kind = TrialRecord
            rows = self._database.rows(
                f"{columns} FROM trials "
                f"WHERE trainee_id = ({TRAINEE_ID}) AND mode = ? AND task = ? AND method = ? "
                "AND trial_id IN (SELECT trial_id FROM results WHERE kind != ?)",
                *(pseudonym, step.mode, step.task, step.method, TRUTH),
            )
        elif step.kind == StepKind.DECIDE:
            kind, query = DrillRecord, f"{columns} FROM drills WHERE trainee_id = ({TRAINEE_ID})"
            rows = self._database.rows(query, pseudonym)
        else:
            return None
        since, counted = self._since(pseudonym, progress), progress.counted_trials
        begun = [
            (started, trial_id, stored_utc)
            for started_utc, trial_id, stored_utc, text in rows
            if (started := moment(started_utc)) >= since
            and trial_id not in counted
            # Last, as decoding takes longer than all the rest.
            and _is_played_as_asked(step, decoded_record(kind, text))
        ]
        if not begun:
            return None
        started, trial_id, stored_utc = min(begun)
        aborted = self._aborted_before(pseudonym, progress)
        if any(moment(record.started_utc) <= started for record in aborted):
            return None
        return steps.StepEntry(step.name, steps.DONE, {"trialId": trial_id}, stored_utc)

    def _since(self, pseudonym: str, progress: steps.StepProgress) -> datetime:
        counted = progress.counted_trials
        after = [
            moment(started_utc)
            for table in ("trials", "drills")
            for trial_id, started_utc in self._database.rows(
                f"SELECT trial_id, started_utc FROM {table} WHERE trainee_id = ({TRAINEE_ID})",
                pseudonym,
            )
            if trial_id in counted
        ]
        return max([*after, moment(progress.enrolled_utc)])

    def _aborted_before(
        self, pseudonym: str, progress: steps.StepProgress
    ) -> tuple[AbortedTrial, ...]:
        step = progress.next_step
        if step is None or step.kind != StepKind.TRIAL:
            return ()
        # Skipping a step settles its aborted trials.
        left_out = [moment(entry.stored_utc) for entry in progress.skipped]
        since = max([self._since(pseudonym, progress), *left_out])
        return tuple(
            record
            for record in self._study.aborted(pseudonym)
            if not record.repeat_reason
            and (record.mode, record.task) == (step.mode, step.task)
            and moment(record.started_utc) >= since
        )


def _is_played_as_asked(step: StudyStep, record: TrialRecord | DrillRecord) -> bool:
    if isinstance(record, DrillRecord):
        return record.mode == step.mode
    procedure = "" if record.procedure is None else record.procedure.procedure
    return (
        procedure == step.procedure
        and step.is_played_on(record.skin.shift_mm, record.skin.indentation_mm)
        and not steps.objections_to(step, record)
    )
