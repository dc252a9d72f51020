"""The experiment menu: who trains, in which mode, on which head, and which task.

It opens the lists of heads, and of the assignments of a trainee's curriculum.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Future
from functools import partial
from typing import Any

from rastrainer.decision.drill_record import CASE_S, CASES
from rastrainer.protocol import DECIDE, TRIAL_RUN, Mode, StepKind, TutorialRule
from rastrainer.scenario.library import ListedScenario
from rastrainer.scenario.scenario import method_of, playable_methods
from rastrainer.study_messages import AssignmentStanding, StudyStep
from rastrainer.trial.scoring import PASS_MARK
from rastrainer_simulator.flow.pages.case import introduction_page, open_drill
from rastrainer_simulator.flow.pages.trainee_id import (
    clicked_id_page,
    keyboard_page,
    questionnaire_page,
)
from rastrainer_simulator.flow.pages.trial_review import own_trials_page
from rastrainer_simulator.flow.session import chosen_trial
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow, page_kind
from rastrainer_simulator.flow.session.session import SessionPage, TrainingSession
from rastrainer_simulator.input.inputs import SourceKind
from rastrainer_simulator.presentation.screen import ItemKind, MenuItem, ScoreTrend

LONGEST_ID = 32

_HEAD = "head "
"""No scenario's name has a space: no head is mistaken for "back"."""
_ASSIGNMENT = "assignment "
"""No assignment's name has a space: none is mistaken for "back"."""


class ExperimentPage(SessionPage):
    """Begins trials; each task waits for the previous task unless the instructor says otherwise."""

    name = "experiment"

    def __init__(self, session: TrainingSession, first: str = "") -> None:
        super().__init__(session)
        self._usual_id = "" if session.trainee_id else chosen_trial.usual_id(session)
        session.trainee = self._usual_id or session.trainee
        self._first = first or self._next_task()

    def content(self) -> PageContent:
        session, step = self.session, self.session.step
        said = () if step is None else (session.step_sentence(step),)
        scores = session.history.trend(session.trainee_id, session.mode)
        trend = None
        if scores:
            # A study may have its own pass mark.
            mark = PASS_MARK if step is None else 0.0
            key = "experiment.trend" if mark else "experiment.trend in study"
            said = (*said, self.say(key, mark=mark))
            shown = session.texts.listed(f"{score:.0f}" for score in scores)
            trend = ScoreTrend(self.say("experiment.scores", scores=shown), scores, mark)
        rows = (*self._choices(), *self._beginnings(), self.button("back"))
        return PageContent(said, rows=rows, trend=trend, first=self._first)

    def set_value(self, name: str, value: Any) -> None:
        """Choose for the session, not for this page alone."""
        setattr(self.session, name, value)

    def _choices(self) -> Iterator[PageRow]:
        session, step, say = self.session, self.session.step, self.say
        if step is not None and step.kind == StepKind.QUESTIONNAIRE:
            yield self.button("answer", partial(self._open_questionnaire, step))
        yield from self._surroundings()
        methods, offered = playable_methods(session.scenario), chosen_trial.offered_method(session)
        others: dict[str, Any] = {"is_enabled": step is None}
        if len(methods) > 1:
            method = offered if step is None else method_of(step.method)
            others["help"], shown = say("experiment.method help"), say(f"method.{method.value}")
            yield self.choice("method", methods, offered, shown, **others)
        names = ["", *(each.name for each in session.scenario.procedures)]
        chosen = session.procedure if session.procedure in names else ""
        if len(names) > 1:
            others["help"] = say("experiment.procedure help")
            shown = session.procedure_title(chosen if step is None else step.procedure)
            yield self.choice("procedure", names, chosen, shown, **others)

    def _surroundings(self) -> Iterator[PageRow]:
        session, say = self.session, self.say
        yield from self._trainee()
        modes, shown = [mode.value for mode in Mode], say(f"mode.{session.mode}")
        yield self.choice("mode", modes, session.mode, shown, label=say("experiment.mode"))
        heads = self.open_page(lambda own: scenario_page(own, own.services.list_scenarios()))
        title = session.scenario.title
        yield self.button("scenario", heads, say("experiment.scenario"), value=title)

    def _trainee(self) -> Iterator[PageRow]:
        """Yield the trainee's ID, and for who only clicks what enters one."""
        session = self.session
        help_ = self.say("experiment.trainee help")
        label = self.say("experiment.trainee")
        item = MenuItem("trainee", label, ItemKind.TEXT, session.trainee, help=help_)
        enter = self.open_page(keyboard_page, self._write_id)
        if session.operator.is_one_of(SourceKind.KEYBOARD, SourceKind.MOUSE):
            enter = partial(session.pages.move, 1)
        yield PageRow(item, enter, write=self._write_id)
        if session.operator.is_one_of(SourceKind.MOUSE):
            clicked = self.open_page(clicked_id_page, self._write_id)
            yield self.button("clicked", clicked, self.say("experiment.clicked"))

    def _write_id(self, value: str) -> None:
        """Set the trainee's ID; the first typed character replaces the usual ID."""
        if value != self._usual_id:
            typed = value.removeprefix(self._usual_id)
            is_deleted = bool(self._usual_id) and value == self._usual_id[:-1]
            self.session.trainee = "" if is_deleted else typed.lstrip()[:LONGEST_ID]
            self._usual_id = ""

    def _beginnings(self) -> Iterator[PageRow]:
        session, curriculum = self.session, self.session.curriculum
        words = session.assignment_texts
        if curriculum is not None:
            summary, advice = words.summary(curriculum), words.advice(curriculum)
            opening = self.open_page(assignments_page)
            yield self.button("assignments", opening, value=summary, help=advice)
        if chosen_trial.tutorial_rule(session) is not TutorialRule.SKIPPED:
            reason = chosen_trial.tutorial_obstacle(session)
            is_done = chosen_trial.has_learned(session)
            yield self.button(
                "tutorial",
                session.begin_tutorial,
                value=self.say("experiment.done" if is_done else "experiment.tutorial time"),
                is_enabled=not reason,
                help=reason or self.say("experiment.tutorial help"),
            )
        what = chosen_trial.skippable(session)
        if what:
            label = self.say(f"experiment.skip {what}")
            yield self.button("skip", partial(self._skip, what), label)
        for name in (task.name for task in session.scenario.tasks):
            reason, outcome = chosen_trial.obstacle(session, name), session.outcome_of(name)
            yield self.button(
                name,
                partial(chosen_trial.start_task, session, name),
                session.task_title(name),
                value=self.say(f"experiment.{outcome}") if outcome else "",
                is_enabled=not reason,
                help=reason or self.say("experiment.task help"),
            )
        if session.step is not None and session.step.kind == StepKind.DECIDE:
            yield self.button(DECIDE, self.open_page(DecidePage), session.task_title(DECIDE))
        count = len(session.history.own(session.trainee_id))
        if count:
            yield self.button("trials", self.open_page(own_trials_page), value=str(count))

    def _skip(self, what: str) -> None:
        session = self.session
        of = "" if what == "tutorial" else session.scenario.name
        session.history.skipped.add((session.trainee_id, of))
        session.pages.focus(self._next_task())

    def _next_task(self) -> str:
        """Return the row of the first task to be done, so that a stray key changes no known ID."""
        session, step = self.session, self.session.step
        if step is not None and step.kind == StepKind.QUESTIONNAIRE:
            return "answer"
        if step is not None and step.kind == StepKind.DECIDE:
            return DECIDE
        if chosen_trial.needs_tutorial(session) and not chosen_trial.tutorial_obstacle(session):
            return "tutorial"
        curriculum = session.curriculum
        best = None if curriculum is None else curriculum.find(curriculum.next)
        if best is not None and not chosen_trial.assignment_obstacle(session, best):
            return "assignments"
        outcomes = ("", "failed") if step is None else ("",)
        trainee, head = session.trainee_id, session.scenario.name
        for name in (task.name for task in session.scenario.tasks):
            is_left_out = name == TRIAL_RUN and session.history.needs_no_trial_run(trainee, head)
            is_to_do = session.outcome_of(name) in outcomes and not is_left_out
            if is_to_do and not chosen_trial.obstacle(session, name):
                return name
        return "mode" if trainee else ""

    def _open_questionnaire(self, step: StudyStep) -> None:
        with self.session.complaining():
            self.session.pages.open(questionnaire_page(self.session, step))


class DecidePage(ExperimentPage):
    """Begins or continues a drill of decisions."""

    name = "decide"

    def content(self) -> PageContent:
        session, step = self.session, self.session.step
        is_open, reason = session.open_drill is not None, chosen_trial.drill_obstacle(session)
        rows = (
            self.button(
                "continue" if is_open else "begin",
                partial(open_drill, session),
                is_enabled=not reason,
                help=reason,
            ),
            *self._surroundings(),
            self.button("introduction", self.open_page(introduction_page)),
            self.button("back"),
        )
        text = self.say("decide.text", cases=CASES, minutes=CASE_S / 60.0)
        said = (text, *(() if step is None else (session.step_sentence(step),)))
        first = "trainee" if reason and not session.trainee_id else rows[0].item.name
        return PageContent(said, rows=rows, first=first)


def open_experiment(
    session: TrainingSession, first: str = "", ignore_input_briefly: bool = False
) -> None:
    session.pages.show_start()
    session.pages.open(ExperimentPage(session, first), ignore_input_briefly)


Listing = Future[list[ListedScenario]]


def _is_loaded(page: SessionPage, _listing: Listing, wanted: str = "") -> bool:
    return wanted == page.session.scenario.name and not page.session.reload.is_under_way


@page_kind("scenario", is_over=_is_loaded)
def scenario_page(page: SessionPage, listing: Listing, wanted: str = "") -> PageContent:
    """List the scenarios, and why some cannot be used; stay if the chosen one is refused."""
    session, is_loading = page.session, page.session.reload.is_under_way
    present = session.scenario.name

    def load(name: str) -> None:
        page.set_value("wanted", name)
        session.reload.use_scenario(name)

    def head(entry: ListedScenario) -> PageRow:
        value = page.say("scenario.present") if entry.name == present else ""
        if entry.name == wanted and is_loading:
            value = page.say("scenario.loading")
        return page.button(
            _HEAD + entry.name,
            partial(load, entry.name),
            entry.title,
            value=value,
            is_enabled=not entry.problem and not is_loading,
            help=entry.problem or page.say("scenario.help"),
            picture=f"/scenarios/{entry.name}.png" if entry.preview else "",
        )

    listed = listing.result() if listing.done() else []
    text = page.say("scenario.text" if listing.done() else "scenario.looking")
    return PageContent(
        (text,), rows=(*map(head, listed), page.button("back")), first=_HEAD + present
    )


@page_kind("assignments", is_over=lambda page: page.session.curriculum is None)
def assignments_page(page: SessionPage) -> PageContent:
    """List the assignments; the next to practice has the focus, and each begins its trial."""
    session, curriculum = page.session, page.session.curriculum
    back, words = page.button("back"), session.assignment_texts
    if curriculum is None:
        return PageContent(rows=(back,))

    def row(each: AssignmentStanding) -> PageRow:
        reason = chosen_trial.assignment_obstacle(session, each)
        return page.button(
            _ASSIGNMENT + each.name,
            partial(begin, each),
            words.label(each),
            value=words.progress(each),
            is_enabled=not reason,
            help=reason or f"{words.title(each)}. {words.goal(each)}",
        )

    def begin(each: AssignmentStanding) -> None:
        session.mode = each.mode or session.mode
        session.method, session.procedure = method_of(each.method), each.procedure
        if each.task == DECIDE:
            session.pages.open(DecidePage(session))
        else:
            chosen_trial.start_task(session, each.task)

    said = (curriculum.title, words.advice(curriculum))
    rows = (*map(row, curriculum.assignments), back)
    return PageContent(said, rows=rows, first=_ASSIGNMENT + curriculum.next)
