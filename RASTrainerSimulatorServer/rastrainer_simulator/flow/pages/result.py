"""What comes after the registration: waiting for the score, and the result."""

from __future__ import annotations

import contextlib
import math
from typing import Any, TypeGuard

from rastrainer.errors import InputError
from rastrainer.json_checks import is_number
from rastrainer.study_messages import StudyStep
from rastrainer.trial.scoring import (
    COMMON_BIAS_LIMIT_MM,
    CONTACT_LIMIT_S,
    CONTACT_PATH_LIMIT_MM,
    DEPTH_LIMIT_MM,
    LIMIT_MM,
)
from rastrainer.trial.trial_feedback import MAX_SHORT
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.procedure import (
    ProcedureErrorsPage,
    procedure_details,
    procedure_facts,
)
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.pages.trial_review import ErrorsPage, ReplayPage
from rastrainer_simulator.flow.session.own_score import OWN_SCORE
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.flow.session.verdict import (
    beyond_limits,
    detail_number,
    is_passed,
    pass_mark,
)
from rastrainer_simulator.presentation.screen import Fact, Menu, MenuItem, Tone
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
"""What is scored: its label, its member of the score's details, its limit, and its text."""
_ONLY_IF_BEYOND = ("contactPathMm",)
_HELPFUL = ("worst", "practice", "again", "errors", "replay", "procedure", "next", "menu")
_ONWARD = ("next", "procedure", "errors", "worst", "replay", "again", "menu")
"""The order of what is offered: first what helps after a failure, else what comes next."""


class FinishedPage(SessionPage):
    """What both pages after a trial offer."""

    def items(self) -> tuple[MenuItem, ...]:
        """Return where the trainee can go from here."""
        best, words = self.session.next_assignment, self.session.assignment_texts
        following = self._following()
        title = self.session.task_title(following) if best is None else words.label(best)
        label = self.say("result.next", task=title)
        again = self.say("result.again", task=self.session.task_title(self.session.training.task))
        buttons = [self.button("next", label)] if following or best is not None else []
        if self._step() is None:
            buttons.append(self.button("again", again))
        return (*buttons, self.button("menu", self.say("result.menu")))

    def accept(self, item: str) -> None:
        """Go to the experiment menu, where the next task has the focus."""
        session = self.session
        first = {"next": self._following(), "again": session.training.task}.get(item, "")
        session.pages.show_start()
        session.pages.open(ExperimentPage(session, first=first))

    def back(self) -> None:
        """Go to the experiment menu."""
        self.accept("next")

    def _step(self) -> StudyStep | None:
        return self.session.study.step_of(self.session.training.trainee)

    def _following(self) -> str:
        """Return the task that comes next; "" for none, or where a curriculum says what does."""
        step = self._step()
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

    def menu(self) -> Menu:
        """Return whom the trainee is waiting for."""
        session = self.session
        own, is_there = session.own_score, session.is_slicer_connected()
        key = "waiting.slicer" if is_there else "waiting.nobody"
        problem = "" if own is None else own.problem
        if not is_there and own is not None and not problem and self._step() is None:
            key = "waiting.own"
        waiting = self.say(key, trainee=session.training.trainee)
        why = (self.say("waiting.problem", reason=problem),) if problem else ()
        facts = _facts_of_trial(session)
        return Menu(self.name, self.say("waiting.title"), (waiting, *why), facts, self.items())


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

    def menu(self) -> Menu:
        """Return the verdict, each value with its limit, and what helps."""
        training, result, texts = self.session.training, self._result, self.session.texts
        verdict = {True: "passed", False: "failed", None: "title"}[self._is_passed]
        task = self.session.task_title(training.task)
        return Menu(
            self.name,
            self.say(f"result.{verdict}", trainee=training.trainee, task=task),
            (
                *self._reasons(),
                *_sentences(texts, result, "feedback", MAX_SHORT),
                *_sentences(texts, result, "warnings", MAX_WARNINGS),
                *self._what_comes_next(),
                *((self.say("result.own"),) if result.details.get(OWN_SCORE) is True else ()),
            ),
            tuple(self._facts()),
            self.items(),
        )

    def items(self) -> tuple[MenuItem, ...]:
        """Return where the trainee can go: after a failure first to what helps.

        A study goes on all the same.
        """
        items = {item.name: item for item in super().items()}
        items |= {name: self.button(name) for name in ("errors", "worst", "replay")}
        if procedure_details(self._result):
            items["procedure"] = self.button("procedure")
        worst = self._worst_point()
        if worst:
            items["practice"] = self.button("practice", self.say("result.practice", point=worst))
        is_helped = self._is_passed is False and self._step() is None
        order = _HELPFUL if is_helped else _ONWARD
        return tuple(items[name] for name in order if name in items)

    def accept(self, item: str) -> None:
        """Show the trial again, practice its worst point, or continue."""
        if item in ("replay", "worst"):
            self._show_again(begins_at_worst=item == "worst")
        elif item == "errors":
            self.session.pages.open(ErrorsPage(self.session))
        elif item == "procedure":
            self.session.pages.open(ProcedureErrorsPage(self.session))
        elif item == "practice":
            self.session.begin_practice(self.session.training.task, self._worst_point())
        else:
            super().accept(item)

    def back(self) -> None:
        """Go to the experiment menu: to the task again, unless it is passed."""
        self.accept("again" if self._is_passed is False else "next")

    def closed(self) -> None:
        """Stop loading the trial."""
        if self._loading is not None:
            self._loading.cancel()

    def _show_again(self, begins_at_worst: bool) -> None:
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
        if self._step() is not None or not training.is_marked or not is_known or not residuals:
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

    def _what_comes_next(self) -> tuple[str, ...]:
        """Return what a study requires after this trial."""
        step = self._step()
        return () if step is None else (self.session.step_sentence(step),)

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
    """Return a text as it is, and what has a key here in the trainee's language; "" for others."""
    if not isinstance(said, dict):
        return said if isinstance(said, str) and said.isprintable() else ""
    key, values = f"feedback.{said.get('key')}", said.get("values")
    if key in texts and isinstance(values, dict):
        # What does not fit the sentence, as that of another version, is said in English.
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
