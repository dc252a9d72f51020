"""The curricula of a study's trainees, and the trials and drills that count for their standing.

Each choice is stored, the last one counts. Scored trials count, and as failures those that were
aborted or can have no score.
"""

from __future__ import annotations

from dataclasses import replace

from rastrainer.decision.drill_rows import drill_rows
from rastrainer.errors import InputError
from rastrainer.study.curriculum.curriculum import Curriculum
from rastrainer.study.curriculum.standing import CurriculumStanding, PassMarkOf, standing_in
from rastrainer.study.database.schema import TRAINEE_ID
from rastrainer.study.database.study import Study
from rastrainer.study.database.values import decoded, json_text
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import pass_mark_of
from rastrainer.trial.trial_row import TrialRow

_STAMPS = """
    SELECT pseudonym,
        (SELECT count(*) FROM aborted_trials WHERE aborted_trials.trainee_id = trainees.id),
        (SELECT count(*) FROM drills WHERE drills.trainee_id = trainees.id),
        (SELECT max(results.id) FROM results JOIN trials ON trials.trial_id = results.trial_id
            WHERE trials.trainee_id = trainees.id),
        (SELECT max(curriculum_choices.id) FROM curriculum_choices
            WHERE curriculum_choices.trainee_id = trainees.id
                OR curriculum_choices.trainee_id IS NULL),
        (SELECT count(*) FROM study_protocol)
    FROM trainees WHERE archived = 0
"""


class CurriculumStore:
    """The curricula of one study. One thread may use it."""

    def __init__(self, study: Study) -> None:
        self._study = study

    def choose(self, curriculum: Curriculum | None, pseudonym: str = "") -> None:
        """Have a trainee follow a curriculum or none; "" means all present and future trainees.

        The last choice counts: a choice for everybody ends the choices for single trainees.
        """
        marks = _marks(self._study)
        for each in () if curriculum is None else curriculum.assignments:
            if each.mark is None and marks(each) is None:
                raise InputError(
                    f"The assignment {each.name} could never be reached: this study's pass mark is "
                    "for trials registered by fiducials. Give the assignment its own mark."
                )
        text = None if curriculum is None else json_text(curriculum.to_json())
        with self._study.database.writing():
            if pseudonym:
                self._study.trainee(pseudonym)
            self._study.database.insert(
                "curriculum_choices", trainee=pseudonym, curriculum_json=text
            )

    def choices(self) -> tuple[tuple[str, Curriculum | None, str], ...]:
        """Return all choices, oldest first: trainee ("" is all), curriculum, time of storing."""
        rows = self._study.database.rows(
            "SELECT coalesce(pseudonym, ''), curriculum_json, curriculum_choices.stored_utc "
            "FROM curriculum_choices LEFT JOIN trainees ON trainees.id = trainee_id "
            "ORDER BY curriculum_choices.id"
        )
        return tuple((name, _read(text), utc) for name, text, utc in rows)

    def standing(self, pseudonym: str) -> CurriculumStanding | None:
        with self._study.database.reading():
            row = self._study.database.row(
                "SELECT curriculum_json FROM curriculum_choices "
                f"WHERE trainee_id = ({TRAINEE_ID}) OR trainee_id IS NULL ORDER BY id DESC LIMIT 1",
                pseudonym,
            )
            curriculum = None if row is None else _read(row[0])
            if curriculum is None:
                return None
            counted = map(_by_procedure, self._study.attempts(pseudonym))
            drills = drill_rows(self._study.drills(pseudonym))
            return standing_in(curriculum, (*counted, *drills), _marks(self._study))

    def stamps(self) -> dict[str, tuple[int | None, ...]]:
        """Return for each active trainee numbers that change with where they may stand.

        They cost little: a window need not compute every standing again whenever something is new.
        """
        rows = self._study.database.rows(_STAMPS)
        return {name: tuple(numbers) for name, *numbers in rows}

    def standings(self) -> dict[str, CurriculumStanding]:
        names = [trainee.pseudonym for trainee in self._study.trainees()]
        return {name: each for name in names if (each := self.standing(name)) is not None}


def _by_procedure(trial: TrialRow) -> TrialRow:
    """Return a trial with the score of its procedure, if it has one."""
    if trial.procedure is None:
        return trial
    done = trial.procedure.score
    values = {**trial.values, "score": done.score}
    return replace(trial, values=values, acceptable=done.acceptable, parts=done.desirabilities)


def _marks(study: Study) -> PassMarkOf:
    protocol = StudyProgress(study).protocol()
    return lambda each: pass_mark_of(protocol, each.method, bool(each.procedure))


def _read(text: str | None) -> Curriculum | None:
    return None if text is None else decoded(text, Curriculum.from_json)
