"""The experiment menu: who trains, in which mode, on which head, and which task.

With it the lists that it opens: of heads, and of the assignments of a trainee's curriculum.
"""

from __future__ import annotations

from rastrainer.errors import InputError
from rastrainer.protocol import TRIAL_RUN, Mode, StepKind, TutorialRule
from rastrainer.scenario.library import ListedScenario
from rastrainer.scenario.scenario import method_of, playable_methods
from rastrainer.study_messages import AssignmentStanding, StudyStep
from rastrainer.trial.scoring import PASS_MARK
from rastrainer_simulator.flow.pages.own_trials import OwnTrialsPage
from rastrainer_simulator.flow.pages.session_page import SessionPage
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
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import SourceKind
from rastrainer_simulator.presentation.screen import ItemKind, Menu, MenuItem, ScoreTrend

LONGEST_ID = 32

_TYPES = (SourceKind.KEYBOARD, SourceKind.MOUSE)
_CLICKS = (SourceKind.MOUSE,)
_HEAD = "head "
"""No scenario's name has a space: no head is taken for the way back."""
_ASSIGNMENT = "assignment "
"""No assignment's name has a space: none is taken for the way back."""


class ExperimentPage(SessionPage):
    """Begins trials; a task waits for the one before it unless the instructor says otherwise."""

    name = "experiment"

    def __init__(self, session: TrainingSession, first: str = "") -> None:
        super().__init__(session)
        self._usual_id = "" if session.trainee.strip() else usual_id(session)
        session.trainee = self._usual_id or session.trainee
        self.first = first or self._next_task()

    def menu(self) -> Menu:
        """Return the menu: trainee, mode and tasks."""
        session = self.session
        trainee = MenuItem(
            "trainee",
            self.say("experiment.trainee"),
            ItemKind.TEXT,
            session.trainee,
            help=self.say("experiment.trainee help"),
        )
        mode = self.choice("mode", self.say(f"mode.{session.mode}"))
        scenario = self.button("scenario", value=session.scenario.title)
        by_mouse = (self.button("clicked"),) if session.operator.is_one_of(_CLICKS) else ()
        choices = (trainee, *by_mouse, mode, scenario, *self._method(), *self._procedure())
        tasks = tuple(self._task(task.name) for task in session.scenario.tasks)
        step = self._step()
        is_asked = step is not None and step.kind == StepKind.QUESTIONNAIRE
        answer = (self.button("answer"),) if is_asked else ()
        said = () if step is None else (session.step_sentence(step),)
        trend = self._trend()
        if trend is not None:
            key = "experiment.trend" if trend.mark else "experiment.trend in study"
            said = (*said, self.say(key, mark=trend.mark))
        return Menu(
            self.name,
            self.say("experiment.title"),
            said,
            items=(
                *answer,
                *choices,
                *self._assignments(),
                *self._tutorial(),
                *self._skip(),
                *tasks,
                *self._own_trials(),
                self.button("back"),
            ),
            trend=trend,
        )

    def accept(self, item: str) -> None:
        """Begin a task, open a list, or type."""
        session = self.session
        lists = {"scenario": ScenarioPage, "assignments": AssignmentsPage, "trials": OwnTrialsPage}
        if item == "back":
            self.back()
        elif item in lists:
            session.pages.open(lists[item](session))
        elif item == "clicked":
            session.pages.open(ClickedIdPage(session, self.write))
        elif item == "answer":
            self._answer()
        elif item == "tutorial":
            session.begin_tutorial()
        elif item == "skip":
            skip(session)
            session.pages.focus(self._next_task())
        elif item != "trainee":
            start_task(session, item)
        elif session.operator.is_one_of(_TYPES):
            session.pages.move(1)
        else:
            session.pages.open(KeyboardPage(session, self.write))

    def step(self, item: str, direction: int) -> None:
        """Change the mode, by what is registered, or what follows that."""
        if item == "mode":
            modes = [mode.value for mode in Mode]
            place = (modes.index(self.session.mode) + direction) % len(modes)
            self.session.mode = modes[place]
        elif item == "method":
            methods = playable_methods(self.session.scenario)
            place = methods.index(offered_method(self.session)) + direction
            self.session.method = methods[place % len(methods)]
        elif item == "procedure":
            names = ["", *(each.name for each in self.session.scenario.procedures)]
            present = self.session.procedure if self.session.procedure in names else ""
            self.session.procedure = names[(names.index(present) + direction) % len(names)]

    def write(self, item: str, value: str) -> None:
        """Set the trainee's ID; what is typed at first replaces the usual one."""
        if item == "trainee" and value != self._usual_id:
            typed = value.removeprefix(self._usual_id)
            is_deleted = bool(self._usual_id) and value == self._usual_id[:-1]
            self.session.trainee = "" if is_deleted else typed.lstrip()[:LONGEST_ID]
            self._usual_id = ""

    def _trend(self) -> ScoreTrend | None:
        """Return the trainee's scores in the chosen mode; a study may have its own pass mark."""
        session = self.session
        scores = session.history.trend(session.trainee.strip(), session.mode)
        if not scores:
            return None
        shown = session.texts.listed(f"{score:.0f}" for score in scores)
        mark = PASS_MARK if self._step() is None else 0.0
        return ScoreTrend(self.say("experiment.scores", scores=shown), scores, mark)

    def _method(self) -> tuple[MenuItem, ...]:
        """Return the choice of what is registered; none where the head has no landmarks."""
        if len(playable_methods(self.session.scenario)) < 2:
            return ()
        step = self._step()
        method = offered_method(self.session) if step is None else method_of(step.method)
        value = self.say(f"method.{method.value}")
        help_ = self.say("experiment.method help")
        return (self.choice("method", value, is_enabled=step is None, help=help_),)

    def _procedure(self) -> tuple[MenuItem, ...]:
        """Return the choice of what follows the touches; none where the head has no procedures."""
        session = self.session
        if not session.scenario.procedures:
            return ()
        step = self._step()
        names = [each.name for each in session.scenario.procedures]
        chosen = session.procedure if session.procedure in names else ""
        value = session.procedure_title(chosen if step is None else step.procedure)
        help_ = self.say("experiment.procedure help")
        return (self.choice("procedure", value, is_enabled=step is None, help=help_),)

    def _assignments(self) -> tuple[MenuItem, ...]:
        """Return the button of the curriculum; none for a trainee without one."""
        curriculum, words = self.session.curriculum, self.session.assignment_texts
        if curriculum is None:
            return ()
        return (
            self.button(
                "assignments", value=words.summary(curriculum), help=words.advice(curriculum)
            ),
        )

    def _tutorial(self) -> tuple[MenuItem, ...]:
        """Return the tutorial's button; none where there is no tutorial."""
        session = self.session
        if tutorial_rule(session) is TutorialRule.SKIPPED:
            return ()
        reason = tutorial_obstacle(session)
        is_done = session.tutorials.has_done(session.trainee.strip(), session.operator.learned)
        value = self.say("experiment.done" if is_done else "experiment.tutorial time")
        help_ = reason or self.say("experiment.tutorial help")
        return (self.button("tutorial", value=value, is_enabled=not reason, help=help_),)

    def _skip(self) -> tuple[MenuItem, ...]:
        """Return what skips the tutorial, then the trial run, where nobody requires them."""
        what = skippable(self.session)
        if not what:
            return ()
        return (self.button("skip", self.say(f"experiment.skip {what}")),)

    def _own_trials(self) -> tuple[MenuItem, ...]:
        """Return the button of the trainee's own trials; none before the first."""
        count = len(self.session.history.own(self.session.trainee.strip()))
        return (self.button("trials", value=str(count)),) if count else ()

    def _task(self, name: str) -> MenuItem:
        """Return a task's button: a disabled one says why."""
        session = self.session
        reason = obstacle(session, name)
        outcome = session.outcome_of(name)
        return MenuItem(
            name,
            session.task_title(name),
            value=self.say(f"experiment.{outcome}") if outcome else "",
            is_enabled=not reason,
            help=reason or self.say("experiment.task help"),
        )

    def _next_task(self) -> str:
        """Return the first task that can be started and is to be done; "" without a trainee.

        One that is not passed is to be done again, outside of a study.

        With the focus there, a stray key does not change the ID of a known trainee.
        """
        step = self._step()
        if step is not None and step.kind == StepKind.QUESTIONNAIRE:
            return "answer"
        if needs_tutorial(self.session) and not tutorial_obstacle(self.session):
            return "tutorial"
        best = self.session.next_assignment
        if best is not None and not assignment_obstacle(self.session, best):
            return "assignments"
        names = [task.name for task in self.session.scenario.tasks]
        to_do = ("", "failed") if step is None else ("",)
        known = "mode" if self.session.trainee.strip() else ""
        return next((name for name in names if self._is_to_do(name, to_do)), known)

    def _is_to_do(self, name: str, outcomes: tuple[str, ...]) -> bool:
        session = self.session
        trainee, head = session.trainee.strip(), session.scenario.name
        if name == TRIAL_RUN and session.progress.needs_no_trial_run(trainee, head):
            return False
        return session.outcome_of(name) in outcomes and not obstacle(session, name)

    def _step(self) -> StudyStep | None:
        return self.session.study.step_of(self.session.trainee.strip())

    def _answer(self) -> None:
        step = self._step()
        if step is None:
            return
        try:
            self.session.pages.open(QuestionnairePage(self.session, step))
        except InputError as error:
            self.session.complain(str(error))


class ScenarioPage(SessionPage):
    """Lists the scenarios; one that cannot be used says why."""

    name = "scenario"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self.first = _HEAD + session.scenario.name
        self._listing = session.list_scenarios()
        self._wanted = ""

    def menu(self) -> Menu:
        """Return the list, as far as it is known."""
        listed = self._listing.result() if self._listing.done() else []
        text = "scenario.text" if self._listing.done() else "scenario.looking"
        items = tuple(self._item(entry) for entry in listed)
        return Menu(
            self.name,
            self.say("scenario.title"),
            (self.say(text),),
            items=(*items, self.button("back")),
        )

    def accept(self, item: str) -> None:
        """Have a head loaded, or go back."""
        if item == "back":
            self.back()
            return
        self._wanted = item.removeprefix(_HEAD)
        self.session.setting_up.use_scenario(self._wanted)

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Go back once the chosen head is loaded; stay if it was refused."""
        if not self._wanted or self.session.setting_up.is_under_way:
            return
        is_there = self.session.scenario.name == self._wanted
        self._wanted = ""
        if is_there:
            self.back()

    def _item(self, entry: ListedScenario) -> MenuItem:
        is_present = entry.name == self.session.scenario.name
        is_loading = self.session.setting_up.is_under_way
        value = "scenario.loading" if entry.name == self._wanted and is_loading else ""
        value = "scenario.present" if is_present and not value else value
        return MenuItem(
            _HEAD + entry.name,
            entry.title,
            value=self.say(value) if value else "",
            is_enabled=not entry.problem and not is_loading,
            help=entry.problem or self.say("scenario.help"),
            picture=f"/scenarios/{entry.name}.png" if entry.preview else "",
        )


class AssignmentsPage(SessionPage):
    """Lists the assignments, the one to practice next in focus; each begins its trial."""

    name = "assignments"

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        curriculum = session.curriculum
        self.first = "" if curriculum is None else _ASSIGNMENT + curriculum.next

    def menu(self) -> Menu:
        """Return the list that Slicer sent last."""
        curriculum = self.session.curriculum
        back = self.button("back")
        if curriculum is None:
            return Menu(self.name, self.say("assignments.title"), items=(back,))
        said = (curriculum.title, self.session.assignment_texts.advice(curriculum))
        items = tuple(self._item(each) for each in curriculum.assignments)
        return Menu(self.name, self.say("assignments.title"), said, items=(*items, back))

    def accept(self, item: str) -> None:
        """Begin a trial of an assignment, or go back."""
        session, curriculum = self.session, self.session.curriculum
        each = None if curriculum is None else curriculum.find(item.removeprefix(_ASSIGNMENT))
        if item == "back" or each is None:
            self.back()
            return
        session.mode = each.mode or session.mode
        session.method, session.procedure = method_of(each.method), each.procedure
        start_task(session, each.task)

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Close where the trainee has no curriculum any more."""
        if self.session.curriculum is None:
            self.back()

    def _item(self, each: AssignmentStanding) -> MenuItem:
        words = self.session.assignment_texts
        reason = assignment_obstacle(self.session, each)
        return MenuItem(
            _ASSIGNMENT + each.name,
            words.label(each),
            value=words.progress(each),
            is_enabled=not reason,
            help=reason or f"{words.title(each)}. {words.goal(each)}",
        )
