"""The pages after the registration: waiting for the score, the result, a procedure's errors."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

from rastrainer.json_checks import is_number
from rastrainer.number_text import clock
from rastrainer.procedure.plan import MAX_TRAJECTORIES
from rastrainer.trial.procedure_outcome import (
    ANGLE_LIMIT_DEG,
    ENTRY_LIMIT_MM,
    PLUNGE_LIMIT_MM,
    TARGET_LIMIT_MM,
)
from rastrainer.trial.scoring import (
    COMMON_BIAS_LIMIT_MM,
    CONTACT_LIMIT_S,
    CONTACT_PATH_LIMIT_MM,
    DEPTH_LIMIT_MM,
    LIMIT_MM,
)
from rastrainer.trial.trial_feedback import MAX_SHORT
from rastrainer_simulator.flow.pages.experiment import open_experiment
from rastrainer_simulator.flow.pages.trial_review import ErrorsPage, ReplayPage
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow, page_kind
from rastrainer_simulator.flow.session.session import SessionPage, TrainingSession
from rastrainer_simulator.flow.session.trainee_history import (
    beyond_limits,
    detail_number,
    is_passed,
    pass_mark,
)
from rastrainer_simulator.presentation.screen import Fact, Tone
from rastrainer_simulator.replay.recorded_trial import TrialLoading
from rastrainer_simulator.state import TrainingState, TrialResult
from rastrainer_simulator.texts.texts import Texts
from rastrainer_simulator.training.local_scorer import SCORED_BY_SIMULATOR

LONGEST_NAME = 60
_SPLIT = (
    ("target", "targetMm", "byRegistrationMm", "byHandMm", TARGET_LIMIT_MM),
    ("entry", "entryMm", "entryByRegistrationMm", "entryByHandMm", ENTRY_LIMIT_MM),
    ("radial", "radialMm", "radialByRegistrationMm", "radialByHandMm", math.inf),
    ("depth", "depthMm", "depthByRegistrationMm", "depthByHandMm", math.inf),
    ("angle", "angleDeg", "angleByRegistrationDeg", "angleByHandDeg", ANGLE_LIMIT_DEG),
)
"""An error, its members in the details of a trajectory, and the limit of the score."""


def procedure_details(result: TrialResult | None) -> Mapping[str, Any]:
    details = None if result is None else result.details.get("procedure")
    return details if isinstance(details, dict) else {}


def procedure_facts(session: TrainingSession, result: TrialResult) -> list[Fact]:
    """Return the procedure's score and its errors in short; [] in a trial of touches alone."""
    details, say = procedure_details(result), session.say
    score = detail_number(details, "score")
    if score is None:
        return []
    is_good = details.get("acceptable") is True
    key = "result.of 100" if is_good else "result.unacceptable score"
    tone = Tone.GOOD if is_good else Tone.WARNING
    facts = [Fact(say("procedure-errors.score"), say(key, score=score), tone)]
    parts = ("targetRmsMm", "targetByRegistrationRmsMm", "targetByHandRmsMm")
    numbers = [detail_number(details, name) for name in parts]
    if None not in numbers:
        values = dict(zip(("error", "registration", "hand"), numbers, strict=True))
        facts.append(Fact(say("procedure-errors.rms"), say("procedure-errors.split mm", **values)))
    each = _trajectories_of(details)
    aligned = sum(one.get("selfAligned") is True for one in each)
    if aligned:
        text = say("procedure-errors.robot lines", count=aligned, lines=len(each))
        facts.append(Fact(say("procedure-errors.robot"), text))
    return facts


def _trajectories_of(details: Mapping[str, Any]) -> Sequence[Mapping[str, Any]]:
    found = details.get("trajectories")
    listed = found[:MAX_TRAJECTORIES] if isinstance(found, list) else []
    return [each for each in listed if isinstance(each, dict)]


@page_kind("procedure-errors")
def procedure_errors_page(page: SessionPage, trajectory: int = 0) -> PageContent:
    each = _trajectories_of(procedure_details(page.session.training.result))
    details = each[trajectory] if each else {}
    name, say = _text(details.get("name")), page.say
    choice = page.choice("trajectory", range(len(each)), trajectory, name)
    lines = page.button("lines", page.open_page(ErrorsPage, True))
    by_robot = details.get("selfAligned") is True
    text = say("procedure-errors.robot text" if by_robot else "procedure-errors.text")
    rows = (*((choice,) if len(each) > 1 else ()), lines, page.button("back"))
    title = say("procedure-errors.title", name=name)
    return PageContent((text,), tuple(_facts(page, details)), rows, title=title)


def _facts(page: SessionPage, details: Mapping[str, Any]) -> Iterator[Fact]:
    say = page.say
    for name, whole, registration, hand, limit in _SPLIT:
        numbers = [detail_number(details, member) for member in (whole, registration, hand)]
        if None not in numbers:
            values = dict(zip(("error", "registration", "hand"), numbers, strict=True))
            unit = "deg" if name == "angle" else "mm"
            text = say(f"procedure-errors.split {unit}", **values)
            yield Fact(say(f"procedure-errors.{name}"), text, _tone(numbers[0], limit))
    plunge, kept = detail_number(details, "plungeMm"), detail_number(details, "keptMm")
    missed, tone = say("procedure-errors.no inner table"), Tone.WARNING
    if plunge is not None:
        missed, tone = say("result.mm", error=plunge), _tone(plunge, PLUNGE_LIMIT_MM)
    yield Fact(say("procedure-errors.plunge"), missed, tone)
    if kept is not None:
        key = "procedure-errors.hit" if kept <= 0.0 else "procedure-errors.kept"
        tone = Tone.ERROR if kept <= 0.0 else Tone.PLAIN
        yield Fact(_text(details.get("nearest")), say(key, distance=kept), tone)


def _tone(error: float | None, limit: float) -> Tone:
    if error is None or math.isinf(limit):
        return Tone.PLAIN
    return Tone.WARNING if abs(error) > limit else Tone.GOOD


def _text(value: object) -> str:
    return value[:LONGEST_NAME] if isinstance(value, str) and value.isprintable() else ""


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


def _following(session: TrainingSession) -> str:
    step = session.trial_step
    if step is not None:
        return step.task if step.is_played else ""
    if session.curriculum is not None:
        return ""
    order = [task.name for task in session.scenario.tasks]
    task = session.training.task
    place = order.index(task) + 1 if task in order else len(order)
    return order[place] if place < len(order) else ""


def _onward(page: SessionPage) -> tuple[PageRow, ...]:
    session = page.session
    curriculum, words = session.curriculum, session.assignment_texts
    best = None if curriculum is None else curriculum.find(curriculum.next)
    following, task = _following(session), session.training.task
    title = session.task_title(following) if best is None else words.label(best)
    again = page.say("result.again", task=session.task_title(task))
    rows = []
    if following or best is not None:
        leave = partial(open_experiment, session, following)
        rows.append(page.button("next", leave, page.say("result.next", task=title)))
    if session.trial_step is None:
        rows.append(page.button("again", partial(open_experiment, session, task), again))
    menu = partial(open_experiment, session)
    return (*rows, page.button("menu", menu, page.say("result.menu")))


@page_kind("waiting", back=lambda page: open_experiment(page.session, _following(page.session)))
def waiting_page(page: SessionPage) -> PageContent:
    session, say = page.session, page.say
    scorer, is_there = session.local_scorer, session.services.is_slicer_connected()
    key = "waiting.slicer" if is_there else "waiting.nobody"
    problem = "" if scorer is None else scorer.problem
    if not is_there and scorer is not None and not problem and session.trial_step is None:
        key = "waiting.own"
    waiting = say(key, trainee=session.training.trainee)
    why = (say("waiting.problem", reason=problem),) if problem else ()
    facts = _facts_of_trial(session)
    return PageContent((waiting, *why), facts, _onward(page))


class ResultPage(SessionPage):
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
        session, training, result = self.session, self.session.training, self._result
        mark = pass_mark(training.task, result.details)
        is_low = mark is not None and result.score < mark
        # The first reason why the trial is not passed; the values show the others.
        reasons = beyond_limits(result.details)[:1] or (["result.below"] if is_low else [])
        step, is_own = session.trial_step, result.details.get(SCORED_BY_SIMULATOR) is True
        said = (
            *map(self.say, reasons),
            *_sentences(session.texts, result, "feedback", MAX_SHORT),
            *_sentences(session.texts, result, "warnings", MAX_WARNINGS),
            *(() if step is None else (session.step_sentence(step),)),
            *((self.say("result.own"),) if is_own else ()),
        )
        label = "procedure-errors.touches" if procedure_details(result) else "result.score"
        key = "result.of 100" if mark is None else "result.of mark"
        value = self.say(key, score=result.score, mark=mark)
        score = Fact(self.say(label), value, Tone.WARNING if reasons else Tone.GOOD)
        verdict = {True: "passed", False: "failed", None: "title"}[self._is_passed]
        task = session.task_title(training.task)
        title = self.say(f"result.{verdict}", trainee=training.trainee, task=task)
        return PageContent(said, self._facts(score), self._rows(), title=title)

    def _facts(self, score: Fact) -> list[Fact]:
        """Return each value with its limit; nothing looks good in a trial that is not passed."""
        result, say = self._result, self.say
        facts = [*procedure_facts(self.session, result), score]
        for label, name, usual, key in _MEASURED:
            value = detail_number(result.details, name)
            # A study sets its own limit of the error in the brain.
            own = detail_number(result.details, "regionLimitMm") if name == "regionTreMm" else None
            limit = own or usual
            if value is None or (name in _ONLY_IF_BEYOND and value <= limit):
                continue
            tone = Tone.WARNING if value > limit else Tone.GOOD
            facts.append(Fact(say(label), say(key, value=value, limit=limit), tone))
        if self._is_passed is not True:
            facts = [
                replace(fact, tone=Tone.PLAIN) if fact.tone is Tone.GOOD else fact for fact in facts
            ]
        errors = (
            ("result.true tre", result.true_tre_mm),
            ("result.expected tre", result.registration.expected_tre_mm),
            ("result.fre", result.registration.fre_mm),
        )
        shown = (Fact(say(key), say("result.mm", error=mm)) for key, mm in errors)
        return [*facts, *_facts_of_trial(self.session), *shown]

    def _rows(self) -> tuple[PageRow, ...]:
        session, is_in_study = self.session, self.session.trial_step is not None
        rows = [
            *_onward(self),
            self.button("errors", self.open_page(ErrorsPage)),
            self.button("worst", partial(self.show_again, begins_at_worst=True)),
            self.button("replay", self.show_again),
        ]
        if procedure_details(self._result):
            rows.append(self.button("procedure", self.open_page(procedure_errors_page)))
        # In a study, practice comes where the study has it.
        worst = "" if is_in_study else _worst_point(session.training, self._result)
        if worst:
            practice = partial(session.begin_tutorial, session.training.task, worst)
            label = self.say("result.practice", point=worst)
            rows.append(self.button("practice", practice, label))
        named = {row.item.name: row for row in rows}
        order = _HELPFUL if self._is_passed is False and not is_in_study else _ONWARD
        return tuple(named[name] for name in order if name in named)

    def back(self) -> None:
        failed = self.session.training.task
        first = failed if self._is_passed is False else _following(self.session)
        open_experiment(self.session, first)

    def closed(self) -> None:
        if self._loading is not None:
            self._loading.cancel()

    def show_again(self, begins_at_worst: bool = False) -> None:
        """Load the trial once, when it is first asked for."""
        session = self.session
        with session.complaining():
            self._loading = self._loading or session.load_trial(session.training.trial_id)
            session.pages.open(ReplayPage(session, self._loading, begins_at_worst))


def _worst_point(training: TrainingState, result: TrialResult) -> str:
    """Return the marked point with the largest residual; "" where it is not known."""
    residuals = result.details.get("residualsMm")
    if not training.is_marked or not training.touches or not isinstance(residuals, list):
        return ""
    if len(residuals) != len(training.touches) or not all(map(is_number, residuals)):
        return ""
    return training.touches[residuals.index(max(residuals))].label


def _facts_of_trial(session: TrainingSession) -> tuple[Fact, ...]:
    training, state, say = session.training, session.state, session.say
    took = state.procedure_time
    procedure = (Fact(say("result.procedure time"), clock(took or 0.0)),)
    return (
        Fact(say("result.time"), clock(state.completion_time)),
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
    if is_number(value):
        return value
    if isinstance(value, dict):
        # A part has no parts itself, however deep the message may be.
        parts = value.get("values")
        items = parts.items() if isinstance(parts, dict) else ()
        plain = {name: part for name, part in items if isinstance(part, str) or is_number(part)}
        return _worded(texts, {**value, "values": plain})
    return _worded(texts, value)
