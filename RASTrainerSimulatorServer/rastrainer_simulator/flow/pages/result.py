"""What comes after the registration: waiting for the score, and the result."""

from __future__ import annotations

import contextlib
import math
from dataclasses import replace
from typing import Any, TypeGuard

from rastrainer.errors import InputError
from rastrainer.json_checks import is_number
from rastrainer.study.protocol.steps import StudyStep
from rastrainer.trial.scoring import PASS_MARK
from rastrainer.trial.trial_feedback import MAX_SHORT
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.procedure import (
    ProcedureErrorsPage,
    procedure_details,
    procedure_facts,
)
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.pages.trial_review import GOOD_MM, POOR_MM, ErrorsPage, ReplayPage
from rastrainer_simulator.flow.session.own_score import OWN_SCORE
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.presentation.screen import Fact, Menu, MenuItem, Tone
from rastrainer_simulator.replay.recorded_trial import TrialLoading
from rastrainer_simulator.state import TrialResult
from rastrainer_simulator.texts.texts import Texts

POOR_SCORE = 40.0
LONGEST_SENTENCE = 300


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
    """The score, its parts, and the trial again."""

    name = "result"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._loading: TrialLoading | None = None

    def menu(self) -> Menu:
        """Return the results with their units."""
        training = self.session.training
        result = training.result
        assert result is not None, "The page is only opened for a scored trial."
        task = self.session.task_title(training.task)
        return Menu(
            self.name,
            self.say("result.title", trainee=training.trainee, task=task),
            (
                *(self.say(key) for key in _beyond_limits(result)),
                *((self.say("result.own"),) if result.details.get(OWN_SCORE) is True else ()),
                *_sentences(self.session.texts, result, "warnings", 3),
                *_feedback(self.session.texts, result),
                self.say("result.interval note"),
                *self._what_comes_next(),
            ),
            (
                *procedure_facts(self.session, result),
                *self._facts_of_result(result),
                *_facts_of_trial(self.session),
            ),
            self.items(),
        )

    def items(self) -> tuple[MenuItem, ...]:
        """Return where the trainee can go, and what can be shown again."""
        items = {item.name: item for item in super().items()}
        has_procedure = bool(procedure_details(self.session.training.result))
        shown = tuple(
            self.button(name)
            for name in ("procedure", "errors", "worst", "replay")
            if name != "procedure" or has_procedure
        )
        onward = [items.pop("next")] if "next" in items else []
        return (*onward, *shown, *items.values())

    def accept(self, item: str) -> None:
        """Show the trial again, or continue."""
        if item in ("replay", "worst"):
            self._show_again(begins_at_worst=item == "worst")
        elif item == "errors":
            self.session.pages.open(ErrorsPage(self.session))
        elif item == "procedure":
            self.session.pages.open(ProcedureErrorsPage(self.session))
        else:
            super().accept(item)

    def closed(self) -> None:
        """Stop loading the trial."""
        if self._loading is not None:
            self._loading.cancel()

    def _show_again(self, begins_at_worst: bool) -> None:
        """Load the trial once, when it is first asked for."""
        session = self.session
        try:
            self._loading = self._loading or session.load_trial()
        except InputError as error:
            session.complain(str(error))
        else:
            session.pages.open(ReplayPage(session, self._loading, begins_at_worst))

    def _what_comes_next(self) -> tuple[str, ...]:
        """Return what a study requires after this trial."""
        step = self._step()
        return () if step is None else (self.session.step_sentence(step),)

    def _facts_of_result(self, result: TrialResult) -> list[Fact]:
        is_unacceptable = bool(_beyond_limits(result))
        key = "result.unacceptable score" if is_unacceptable else "result.of 100"
        tone = _tone_of_score(result)
        facts = [
            Fact(self._score_label(result), self.say(key, score=result.score), tone),
            self._error("result.fre", result.registration.fre_mm),
            self._error("result.expected tre", result.registration.expected_tre_mm),
            self._error("result.true tre", result.true_tre_mm),
        ]
        region = result.details.get("regionTreMm")
        if _is_number(region):
            fact = self._error("result.region tre", float(region))
            is_beyond = result.details.get("isAccurate") is False
            facts.append(replace(fact, tone=Tone.WARNING) if is_beyond else fact)
        bias = result.details.get("commonBiasMm")
        if _is_number(bias):
            text = self.say("result.mm", error=float(bias))
            is_biased = result.details.get("isUnbiased") is False
            tone = Tone.WARNING if is_biased else Tone.PLAIN
            facts.append(Fact(self.say("result.common bias"), text, tone))
        if is_unacceptable:
            facts = [_not_good(fact) for fact in facts]
        ctps = result.details.get("ctps")
        if _is_number(ctps):
            facts.append(
                Fact(self.say("result.ctps"), self.say("result.points", points=float(ctps)))
            )
        return facts

    def _score_label(self, result: TrialResult) -> str:
        """Return what the score is for: a procedure has its own."""
        has_procedure = bool(procedure_details(result))
        return self.say("procedure-errors.touches" if has_procedure else "result.score")

    def _error(self, key: str, error_mm: float) -> Fact:
        tone = Tone.GOOD if error_mm <= GOOD_MM else Tone.PLAIN
        tone = Tone.WARNING if error_mm >= POOR_MM else tone
        return Fact(self.say(key), self.say("result.mm", error=error_mm), tone)


def _beyond_limits(result: TrialResult) -> list[str]:
    """Return the keys of the sentences that say why a trial is not acceptable."""
    limits = (
        ("isAccurate", "result.not accurate"),
        ("isUnbiased", "result.not unbiased"),
        ("isSafe", "result.not safe"),
    )
    return [key for name, key in limits if result.details.get(name) is False]


def _not_good(fact: Fact) -> Fact:
    """Nothing looks good about a trial that would have missed the target or hurt the patient."""
    return replace(fact, tone=Tone.PLAIN) if fact.tone is Tone.GOOD else fact


def _tone_of_score(result: TrialResult) -> Tone:
    if _beyond_limits(result):
        return Tone.WARNING
    mark = result.details.get("passMark", PASS_MARK)
    if _is_number(mark) and result.score >= mark:
        return Tone.GOOD
    return Tone.WARNING if result.score < POOR_SCORE else Tone.PLAIN


def _facts_of_trial(session: TrainingSession) -> tuple[Fact, ...]:
    training = session.training
    say = session.texts.say
    return (
        Fact(say("result.time"), session.duration(session.state.elapsed)),
        Fact(say("result.repeated"), f"{training.rejected} / {training.undone}"),
    )


def _feedback(texts: Texts, result: TrialResult) -> list[str]:
    """Return the feedback; that a trial is not acceptable is said before it, with the reason."""
    feedback = result.details.get("feedback")
    if _beyond_limits(result) and isinstance(feedback, list):
        others = [
            e for e in feedback if not (isinstance(e, dict) and e.get("key") == "unacceptable")
        ]
        result = replace(result, details={**result.details, "feedback": others})
    return _sentences(texts, result, "feedback", MAX_SHORT)


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
