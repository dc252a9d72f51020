"""The pages after the registration: waiting for the score, and the result."""

from __future__ import annotations

import contextlib
import math
from functools import partial
from typing import Any, TypeGuard

from rastrainer.errors import InputError
from rastrainer.json_checks import is_number
from rastrainer.trial.scoring import (
    COMMON_BIAS_LIMIT_MM,
    CONTACT_LIMIT_S,
    CONTACT_PATH_LIMIT_MM,
    DEPTH_LIMIT_MM,
    LIMIT_MM,
)
from rastrainer.trial.trial_feedback import MAX_SHORT
from rastrainer_simulator.flow.pages.experiment import open_experiment
from rastrainer_simulator.flow.pages.procedure import (
    ProcedureErrorsPage,
    procedure_details,
    procedure_facts,
)
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.pages.trial_review import ErrorsPage, ReplayPage
from rastrainer_simulator.flow.session.local_scorer import SCORED_BY_SIMULATOR
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.flow.session.verdict import (
    beyond_limits,
    detail_number,
    is_passed,
    pass_mark,
)
from rastrainer_simulator.presentation.screen import Fact, Tone
from rastrainer_simulator.replay.recorded_trial import TrialLoading
from rastrainer_simulator.state import TrialResult
from rastrainer_simulator.texts.texts import Texts

LONGEST_SENTENCE = 300
MAX_WARNINGS = 2
_MEASURED = (
    ("result.region tre", "regionTreMm", LIMIT_MM, "result.mm of"),
    ("result.common bias", "commonBiasMm", COMMON_BIAS_LIMIT_MM, "result.mm of"),
    ("result.contact", "contactTimeS", CONTACT_LIMIT_S, "result.seconds of"),
    ("result.contact path", "contactPathMm", CONTACT_PATH_LIMIT_MM, "result.millimeters of"),
    ("result.depth", "pressingDepthMm", DEPTH_LIMIT_MM, "result.mm of"),
)
"""Scored measures: label, member of the score's details, limit, and text."""
_ONLY_IF_BEYOND = ("contactPathMm",)
_HELPFUL = ("worst", "practice", "again", "errors", "replay", "procedure", "next", "menu")
_ONWARD = ("next", "procedure", "errors", "worst", "replay", "again", "menu")
"""Orders of the rows: after a failure help comes first, else the next task."""


class FinishedPage(SessionPage):
    """What both pages after a trial offer."""

    def onward(self) -> tuple[PageRow, ...]:
        """Return where the trainee can go from here."""
        session = self.session
        best, words = session.next_assignment, session.assignment_texts
        following, task = self._following(), session.training.task
        title = session.task_title(following) if best is None else words.label(best)
        again = self.say("result.again", task=session.task_title(task))
        rows = []
        if following or best is not None:
            leave = partial(open_experiment, session, following)
            rows.append(self.button("next", leave, self.say("result.next", task=title)))
        if self.session.trial_step is None:
            rows.append(self.button("again", partial(open_experiment, session, task), again))
        menu = partial(open_experiment, session)
        return (*rows, self.button("menu", menu, self.say("result.menu")))

    def back(self) -> None:
        """Go to the next task."""
        open_experiment(self.session, self._following())

    def _following(self) -> str:
        """Return the task that comes next; "" for none, or where a curriculum says what does."""
        step = self.session.trial_step
        if step is not None:
            return step.task if step.is_played else ""
        if self.session.curriculum is not None:
            return ""
        order = [task.name for task in self.session.scenario.tasks]
        task = self.session.training.task
        place = order.index(task) + 1 if task in order else len(order)
        return order[place] if place < len(order) else ""


class WaitingPage(FinishedPage):
    """The points are registered, and the score has not come yet."""

    name = "waiting"

    def content(self) -> PageContent:
        session = self.session
        own, is_there = session.local_scorer, session.is_slicer_connected()
        key = "waiting.slicer" if is_there else "waiting.nobody"
        problem = "" if own is None else own.problem
        if not is_there and own is not None and not problem and self.session.trial_step is None:
            key = "waiting.own"
        waiting = self.say(key, trainee=session.training.trainee)
        why = (self.say("waiting.problem", reason=problem),) if problem else ()
        facts, title = _facts_of_trial(session), self.say("waiting.title")
        return PageContent(title, (waiting, *why), facts, self.onward())


class ResultPage(FinishedPage):
    """Whether the trial is passed, why, what helps, and the trial again."""

    name = "result"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._loading: TrialLoading | None = None

    @property
    def _result(self) -> TrialResult:
        result = self.session.training.result
        assert result is not None, "The page is only opened for a scored trial."
        return result

    @property
    def _is_passed(self) -> bool | None:
        result = self._result
        return is_passed(self.session.training.task, result.score, result.details)

    def content(self) -> PageContent:
        training, result, texts = self.session.training, self._result, self.session.texts
        verdict = {True: "passed", False: "failed", None: "title"}[self._is_passed]
        task = self.session.task_title(training.task)
        step = self.session.trial_step
        said = (
            *self._reasons(),
            *_sentences(texts, result, "feedback", MAX_SHORT),
            *_sentences(texts, result, "warnings", MAX_WARNINGS),
            *(() if step is None else (self.session.step_sentence(step),)),
            *((self.say("result.own"),) if result.details.get(SCORED_BY_SIMULATOR) is True else ()),
        )
        title = self.say(f"result.{verdict}", trainee=training.trainee, task=task)
        return PageContent(title, said, self._facts(), self.onward())

    def onward(self) -> tuple[PageRow, ...]:
        """Return where the trainee can go: after a failure first to what helps.

        A study goes on all the same.
        """
        rows = [
            *super().onward(),
            self.button("errors", self.open_page(ErrorsPage)),
            self.button("worst", partial(self.show_again, begins_at_worst=True)),
            self.button("replay", self.show_again),
        ]
        if procedure_details(self._result):
            rows.append(self.button("procedure", self.open_page(ProcedureErrorsPage)))
        worst = self._worst_point()
        if worst:
            practice = partial(self.session.begin_practice, self.session.training.task, worst)
            label = self.say("result.practice", point=worst)
            rows.append(self.button("practice", practice, label))
        is_helped = self._is_passed is False and self.session.trial_step is None
        named = {row.item.name: row for row in rows}
        order = _HELPFUL if is_helped else _ONWARD
        return tuple(named[name] for name in order if name in named)

    def back(self) -> None:
        """Go to the next task, or to this one again where it is not passed."""
        failed = self.session.training.task
        first = failed if self._is_passed is False else self._following()
        open_experiment(self.session, first)

    def closed(self) -> None:
        if self._loading is not None:
            self._loading.cancel()

    def show_again(self, begins_at_worst: bool = False) -> None:
        """Load the trial once, when it is first asked for."""
        session = self.session
        try:
            self._loading = self._loading or session.load_trial(session.training.trial_id)
        except InputError as error:
            session.complain(str(error))
        else:
            session.pages.open(ReplayPage(session, self._loading, begins_at_worst))

    def _worst_point(self) -> str:
        """Return the marked point with the largest residual; "" where it is not known.

        In a study, practice comes where the study has it.
        """
        training = self.session.training
        residuals = self._result.details.get("residualsMm")
        is_known = isinstance(residuals, list) and len(residuals) == len(training.touches)
        if (
            self.session.trial_step is not None
            or not training.is_marked
            or not is_known
            or not residuals
        ):
            return ""
        if not all(map(is_number, residuals)):
            return ""
        return training.touches[residuals.index(max(residuals))].label

    def _reasons(self) -> tuple[str, ...]:
        """Return the first reason why the trial is not passed; the values show the others."""
        reasons = beyond_limits(self._result.details)[:1]
        mark = self._mark
        if not reasons and mark is not None and self._result.score < mark:
            reasons = ["result.below"]
        return tuple(self.say(key) for key in reasons)

    @property
    def _mark(self) -> float | None:
        return pass_mark(self.session.training.task, self._result.details)

    def _facts(self) -> list[Fact]:
        """Return each value with its limit; nothing looks good in a trial that is not passed."""
        session, result = self.session, self._result
        facts = [*procedure_facts(session, result), self._score(), *self._measured()]
        if self._is_passed is not True:
            facts = [_not_good(fact) for fact in facts]
        errors = (
            ("result.true tre", result.true_tre_mm),
            ("result.expected tre", result.registration.expected_tre_mm),
            ("result.fre", result.registration.fre_mm),
        )
        shown = (Fact(self.say(key), self.say("result.mm", error=mm)) for key, mm in errors)
        return [*facts, *_facts_of_trial(session), *shown]

    def _score(self) -> Fact:
        result, mark = self._result, self._mark
        has_procedure = bool(procedure_details(result))
        label = self.say("procedure-errors.touches" if has_procedure else "result.score")
        key = "result.of 100" if mark is None else "result.of mark"
        is_low = bool(beyond_limits(result.details)) or (mark is not None and result.score < mark)
        tone = Tone.WARNING if is_low else Tone.GOOD
        return Fact(label, self.say(key, score=result.score, mark=mark), tone)

    def _measured(self) -> list[Fact]:
        details, facts = self._result.details, []
        for label, name, usual, key in _MEASURED:
            value = detail_number(details, name)
            # A study sets its own limit of the error in the brain.
            own = detail_number(details, "regionLimitMm") if name == "regionTreMm" else None
            limit = own or usual
            if value is None or (name in _ONLY_IF_BEYOND and value <= limit):
                continue
            tone = Tone.WARNING if value > limit else Tone.GOOD
            facts.append(Fact(self.say(label), self.say(key, value=value, limit=limit), tone))
        return facts


def _not_good(fact: Fact) -> Fact:
    return Fact(fact.label, fact.value) if fact.tone is Tone.GOOD else fact


def _facts_of_trial(session: TrainingSession) -> tuple[Fact, ...]:
    training, state, say = session.training, session.state, session.texts.say
    took = state.procedure_time
    procedure = (Fact(say("result.procedure time"), session.duration(took or 0.0)),)
    return (
        Fact(say("result.time"), session.duration(state.completion_time)),
        *(() if took is None else procedure),
        Fact(say("result.repeated"), f"{training.rejected} / {training.undone}"),
    )


def _sentences(texts: Texts, result: TrialResult, name: str, most: int) -> list[str]:
    """Return what Slicer says about the registration: anything but sentences is left out."""
    said = result.details.get(name)
    if not isinstance(said, list):
        return []
    worded = (_worded(texts, each) for each in said[:most])
    return [sentence[:LONGEST_SENTENCE] for sentence in worded if sentence]


def _worded(texts: Texts, said: Any) -> str:
    """Return a text as it is, a sentence with a known key in the trainee's language, else ""."""
    if not isinstance(said, dict):
        return said if isinstance(said, str) and said.isprintable() else ""
    key, values = f"feedback.{said.get('key')}", said.get("values")
    if key in texts and isinstance(values, dict):
        # Values that do not fit the sentence: say it in English.
        with contextlib.suppress(KeyError, ValueError, TypeError):
            return texts.say(key, **{name: _value(texts, value) for name, value in values.items()})
    text = said.get("text")
    return text if isinstance(text, str) and text.isprintable() else ""


def _value(texts: Texts, value: Any) -> Any:
    """Return a number as it is, and a text or a part of a sentence worded."""
    if _is_number(value):
        return value
    if isinstance(value, dict):
        # A part has no parts itself, however deep the message may be.
        return _worded(texts, {**value, "values": _plain(value.get("values"))})
    return _worded(texts, value)


def _plain(values: Any) -> dict[str, Any]:
    """Return those values that are numbers or texts."""
    items = values.items() if isinstance(values, dict) else ()
    return {name: value for name, value in items if isinstance(value, str) or _is_number(value)}


def _is_number(value: object) -> TypeGuard[float]:
    return is_number(value) and math.isfinite(value)
