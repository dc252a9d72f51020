"""The experiment menu: who trains, in which mode, on which head, and which task.

It opens the lists of heads, and of the assignments of a trainee's curriculum.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial

from rastrainer.errors import InputError
from rastrainer.protocol import TRIAL_RUN, Mode, StepKind, TutorialRule
from rastrainer.scenario.library import ListedScenario
from rastrainer.scenario.scenario import method_of, playable_methods
from rastrainer.study_messages import AssignmentStanding, StudyStep
from rastrainer.trial.scoring import PASS_MARK
from rastrainer_simulator.flow.pages.own_trials import OwnTrialsPage
from rastrainer_simulator.flow.pages.session_page import SessionPage, stepped
from rastrainer_simulator.flow.pages.trainee_id import (
    ClickedIdPage,
    KeyboardPage,
    QuestionnairePage,
)
from rastrainer_simulator.flow.session.chosen_trial import (
    assignment_obstacle,
    needs_tutorial,
    obstacle,
    offered_method,
    skip,
    skippable,
    start_task,
    tutorial_obstacle,
    tutorial_rule,
    usual_id,
)
from rastrainer_simulator.flow.session.open_pages import PageContent, PageRow
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import SourceKind
from rastrainer_simulator.presentation.screen import ItemKind, MenuItem, ScoreTrend

LONGEST_ID = 32

_TYPES = (SourceKind.KEYBOARD, SourceKind.MOUSE)
_CLICKS = (SourceKind.MOUSE,)
_HEAD = "head "
"""No scenario's name has a space: no head is mistaken for "back"."""
_ASSIGNMENT = "assignment "
"""No assignment's name has a space: none is mistaken for "back"."""


class ExperimentPage(SessionPage):
    """Begins trials; each task waits for the previous task unless the instructor says otherwise."""

    name = "experiment"

    def __init__(self, session: TrainingSession, first: str = "") -> None:
        super().__init__(session)
        self._usual_id = "" if session.trainee_id else usual_id(session)
        session.trainee = self._usual_id or session.trainee
        self.first = first or self._next_task()

    def content(self) -> PageContent:
        session = self.session
        step = self.session.step
        said = () if step is None else (session.step_sentence(step),)
        trend = self._trend()
        if trend is not None:
            key = "experiment.trend" if trend.mark else "experiment.trend in study"
            said = (*said, self.say(key, mark=trend.mark))
        rows = (
            *self._answer(),
            *self._trainee(),
            self.choice("mode", self.say(f"mode.{session.mode}"), self._step_mode),
            self.button("scenario", self.open_page(ScenarioPage), value=session.scenario.title),
            *self._method(),
            *self._procedure(),
            *self._assignments(),
            *self._tutorial(),
            *self._skip(),
            *(self._task(task.name) for task in session.scenario.tasks),
            *self._own_trials(),
            self.button("back"),
        )
        return PageContent(self.say("experiment.title"), said, rows=rows, trend=trend)

    def _trainee(self) -> Iterator[PageRow]:
        """Yield the trainee's ID, and for who only clicks what enters one."""
        session = self.session
        item = MenuItem(
            "trainee",
            self.say("experiment.trainee"),
            ItemKind.TEXT,
            session.trainee,
            help=self.say("experiment.trainee help"),
        )
        enter = self.open_page(KeyboardPage, self._write_id)
        if session.operator.is_one_of(_TYPES):
            enter = partial(session.pages.move, 1)
        yield PageRow(item, enter, write=self._write_id)
        if session.operator.is_one_of(_CLICKS):
            yield self.button("clicked", self.open_page(ClickedIdPage, self._write_id))

    def _write_id(self, value: str) -> None:
        """Set the trainee's ID; the first typed character replaces the usual ID."""
        if value != self._usual_id:
            typed = value.removeprefix(self._usual_id)
            is_deleted = bool(self._usual_id) and value == self._usual_id[:-1]
            self.session.trainee = "" if is_deleted else typed.lstrip()[:LONGEST_ID]
            self._usual_id = ""

    def _step_mode(self, direction: int) -> None:
        modes = [mode.value for mode in Mode]
        self.session.mode = stepped(modes, self.session.mode, direction)

    def _trend(self) -> ScoreTrend | None:
        """Return the trainee's scores in the chosen mode; a study may have its own pass mark."""
        session = self.session
        scores = session.history.trend(session.trainee_id, session.mode)
        if not scores:
            return None
        shown = session.texts.listed(f"{score:.0f}" for score in scores)
        mark = PASS_MARK if self.session.step is None else 0.0
        return ScoreTrend(self.say("experiment.scores", scores=shown), scores, mark)

    def _method(self) -> Iterator[PageRow]:
        """Yield the choice of the method of registration; none if the head has no landmarks."""
        session, step = self.session, self.session.step
        methods, offered = playable_methods(session.scenario), offered_method(session)

        def step_method(direction: int) -> None:
            session.method = stepped(methods, offered, direction)

        if len(methods) > 1:
            method = offered if step is None else method_of(step.method)
            value, help_ = self.say(f"method.{method.value}"), self.say("experiment.method help")
            yield self.choice("method", value, step_method, is_enabled=step is None, help=help_)

    def _procedure(self) -> Iterator[PageRow]:
        """Yield the choice of what follows the touches; none where the head has no procedures."""
        session, step = self.session, self.session.step
        names = ["", *(each.name for each in session.scenario.procedures)]
        chosen = session.procedure if session.procedure in names else ""

        def step_procedure(direction: int) -> None:
            session.procedure = stepped(names, chosen, direction)

        if len(names) > 1:
            value = session.procedure_title(chosen if step is None else step.procedure)
            help_ = self.say("experiment.procedure help")
            yield self.choice(
                "procedure", value, step_procedure, is_enabled=step is None, help=help_
            )

    def _assignments(self) -> Iterator[PageRow]:
        """Yield the button of the curriculum; none for a trainee without one."""
        curriculum, words = self.session.curriculum, self.session.assignment_texts
        if curriculum is not None:
            yield self.button(
                "assignments",
                self.open_page(AssignmentsPage),
                value=words.summary(curriculum),
                help=words.advice(curriculum),
            )

    def _tutorial(self) -> Iterator[PageRow]:
        """Yield the tutorial's button; none where there is no tutorial."""
        session = self.session
        if tutorial_rule(session) is TutorialRule.SKIPPED:
            return
        reason = tutorial_obstacle(session)
        is_done = session.tutorials.has_done(session.trainee_id, session.operator.learned)
        value = self.say("experiment.done" if is_done else "experiment.tutorial time")
        yield self.button(
            "tutorial",
            session.begin_tutorial,
            value=value,
            is_enabled=not reason,
            help=reason or self.say("experiment.tutorial help"),
        )

    def _skip(self) -> Iterator[PageRow]:
        """Yield what skips the tutorial, then the trial run, where nobody requires them."""
        what = skippable(self.session)
        if what:
            yield self.button("skip", self._skip_next, self.say(f"experiment.skip {what}"))

    def _skip_next(self) -> None:
        skip(self.session)
        self.session.pages.focus(self._next_task())

    def _own_trials(self) -> Iterator[PageRow]:
        count = len(self.session.history.own(self.session.trainee_id))
        if count:
            yield self.button("trials", self.open_page(OwnTrialsPage), value=str(count))

    def _task(self, name: str) -> PageRow:
        """Return a task's button: a disabled one says why."""
        session = self.session
        reason = obstacle(session, name)
        outcome = session.outcome_of(name)
        return self.button(
            name,
            partial(start_task, session, name),
            session.task_title(name),
            value=self.say(f"experiment.{outcome}") if outcome else "",
            is_enabled=not reason,
            help=reason or self.say("experiment.task help"),
        )

    def _next_task(self) -> str:
        """Return the first task that can be started and is to be done; "" without a trainee.

        One that is not passed is to be done again, outside of a study.

        Then a stray key does not change the ID of a known trainee.
        """
        step = self.session.step
        if step is not None and step.kind == StepKind.QUESTIONNAIRE:
            return "answer"
        if needs_tutorial(self.session) and not tutorial_obstacle(self.session):
            return "tutorial"
        best = self.session.next_assignment
        if best is not None and not assignment_obstacle(self.session, best):
            return "assignments"
        names = [task.name for task in self.session.scenario.tasks]
        to_do = ("", "failed") if step is None else ("",)
        known = "mode" if self.session.trainee_id else ""
        return next((name for name in names if self._is_to_do(name, to_do)), known)

    def _is_to_do(self, name: str, outcomes: tuple[str, ...]) -> bool:
        session = self.session
        trainee, head = session.trainee_id, session.scenario.name
        if name == TRIAL_RUN and session.progress.needs_no_trial_run(trainee, head):
            return False
        return session.outcome_of(name) in outcomes and not obstacle(session, name)

    def _answer(self) -> Iterator[PageRow]:
        step = self.session.step
        if step is not None and step.kind == StepKind.QUESTIONNAIRE:
            yield self.button("answer", partial(self._open_questionnaire, step))

    def _open_questionnaire(self, step: StudyStep) -> None:
        try:
            self.session.pages.open(QuestionnairePage(self.session, step))
        except InputError as error:
            self.session.complain(str(error))


def open_experiment(
    session: TrainingSession, first: str = "", ignore_input_briefly: bool = False
) -> None:
    """Open the experiment menu over the start page; `first` is the row with the focus."""
    session.pages.show_start()
    session.pages.open(ExperimentPage(session, first), ignore_input_briefly)


class ScenarioPage(SessionPage):
    """Lists the scenarios, and why some cannot be used."""

    name = "scenario"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self.first = _HEAD + session.scenario.name
        self._listing = session.list_scenarios()
        self._wanted = ""

    def content(self) -> PageContent:
        """Return the list, as far as it is known."""
        listed = self._listing.result() if self._listing.done() else []
        text = self.say("scenario.text" if self._listing.done() else "scenario.looking")
        rows = (*map(self._head, listed), self.button("back"))
        return PageContent(self.say("scenario.title"), (text,), rows=rows)

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Go back once the chosen head is loaded; stay if it was refused."""
        if not self._wanted or self.session.reload.is_under_way:
            return
        is_there = self.session.scenario.name == self._wanted
        self._wanted = ""
        if is_there:
            self.back()

    def _head(self, entry: ListedScenario) -> PageRow:
        is_present = entry.name == self.session.scenario.name
        is_loading = self.session.reload.is_under_way
        value = "scenario.loading" if entry.name == self._wanted and is_loading else ""
        value = "scenario.present" if is_present and not value else value
        return self.button(
            _HEAD + entry.name,
            partial(self._load, entry.name),
            entry.title,
            value=self.say(value) if value else "",
            is_enabled=not entry.problem and not is_loading,
            help=entry.problem or self.say("scenario.help"),
            picture=f"/scenarios/{entry.name}.png" if entry.preview else "",
        )

    def _load(self, name: str) -> None:
        self._wanted = name
        self.session.reload.use_scenario(name)


class AssignmentsPage(SessionPage):
    """Lists the assignments; the next to practice has the focus, and each begins its trial."""

    name = "assignments"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        curriculum = session.curriculum
        self.first = "" if curriculum is None else _ASSIGNMENT + curriculum.next

    def content(self) -> PageContent:
        """Return the list that Slicer sent last."""
        curriculum, title = self.session.curriculum, self.say("assignments.title")
        back = self.button("back")
        if curriculum is None:
            return PageContent(title, rows=(back,))
        said = (curriculum.title, self.session.assignment_texts.advice(curriculum))
        return PageContent(title, said, rows=(*map(self._assignment, curriculum.assignments), back))

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Close where the trainee has no curriculum any more."""
        if self.session.curriculum is None:
            self.back()

    def _assignment(self, each: AssignmentStanding) -> PageRow:
        words = self.session.assignment_texts
        reason = assignment_obstacle(self.session, each)
        return self.button(
            _ASSIGNMENT + each.name,
            partial(self._begin, each),
            words.label(each),
            value=words.progress(each),
            is_enabled=not reason,
            help=reason or f"{words.title(each)}. {words.goal(each)}",
        )

    def _begin(self, each: AssignmentStanding) -> None:
        session = self.session
        session.mode = each.mode or session.mode
        session.method, session.procedure = method_of(each.method), each.procedure
        start_task(session, each.task)
