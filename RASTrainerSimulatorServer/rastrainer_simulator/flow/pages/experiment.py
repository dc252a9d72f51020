"""The experiment menu: who trains, in which mode, on which head, and which task."""

from __future__ import annotations

from rastrainer.errors import InputError
from rastrainer.experiment.study_step import StudyStep
from rastrainer.protocol import CommandName, Mode, StepKind
from rastrainer_simulator.controls.source import SourceKind
from rastrainer_simulator.flow.page import Page
from rastrainer_simulator.flow.pages.keyboard import KeyboardPage
from rastrainer_simulator.flow.pages.questionnaire import QuestionnairePage
from rastrainer_simulator.flow.pages.scenario import ScenarioPage
from rastrainer_simulator.flow.screen import Item, ItemKind, Menu
from rastrainer_simulator.flow.session import Session

LONGEST_ID = 32

_TYPES = (SourceKind.KEYBOARD, SourceKind.MOUSE)


class ExperimentPage(Page):
    """Begins trials; a task waits for the one before it unless the instructor says otherwise."""

    name = "experiment"

    def __init__(self, session: Session, first: str = "") -> None:
        super().__init__(session)
        self.first = first

    def menu(self) -> Menu:
        """Return who, how and what."""
        session = self.session
        trainee = Item(
            "trainee",
            self.say("experiment.trainee"),
            ItemKind.TEXT,
            session.trainee,
            help=self.say("experiment.trainee help"),
        )
        mode = self.choice("mode", self.say(f"mode.{session.mode}"))
        scenario = self.button("scenario", value=session.scenario.title)
        tasks = tuple(self._task(task.name) for task in session.scenario.tasks)
        step = self._step()
        is_asked = step is not None and step.kind == StepKind.QUESTIONNAIRE
        answer = (self.button("answer"),) if is_asked else ()
        return Menu(
            self.name,
            self.say("experiment.title"),
            () if step is None else (session.step_sentence(step),),
            items=(*answer, trainee, mode, scenario, *tasks, self.button("back")),
        )

    def accept(self, item: str) -> None:
        """Begin a task, or type."""
        if item == "back":
            self.back()
        elif item == "scenario":
            self.session.pages.open(ScenarioPage(self.session))
        elif item == "answer":
            self._answer()
        elif item == "trainee":
            if self.session.is_typing_possible(_TYPES):
                self.session.pages.move(1)
            else:
                self.session.pages.open(KeyboardPage(self.session, self.write))
        else:
            self._begin(item)

    def step(self, item: str, direction: int) -> None:
        """Change the mode."""
        if item == "mode":
            modes = [mode.value for mode in Mode]
            place = (modes.index(self.session.mode) + direction) % len(modes)
            self.session.mode = modes[place]

    def write(self, item: str, value: str) -> None:
        """Take the trainee's ID."""
        if item == "trainee":
            self.session.trainee = value.lstrip()[:LONGEST_ID]

    def _task(self, name: str) -> Item:
        """Return a task's button: a disabled one says why."""
        session = self.session
        reason = self._obstacle(name)
        is_done = session.progress.has_done(session.trainee.strip(), session.scenario.name, name)
        return Item(
            name,
            session.task_title(name),
            value=self.say("experiment.done") if is_done else "",
            is_enabled=not reason,
            help=reason or self.say("experiment.task help"),
        )

    def _obstacle(self, name: str) -> str:
        session = self.session
        trainee = session.trainee.strip()
        if not trainee:
            return self.say("experiment.no trainee")
        if session.is_being_set_up:
            return self.say("experiment.being set up")
        step = self._step()
        if step is not None:
            is_asked = step.is_played and (step.task, step.mode) == (name, session.mode)
            sentence = session.step_sentence(step)
            return "" if is_asked else self.say("experiment.study", step=sentence)
        if session.preferences.order == "any":
            return ""
        scenario = session.scenario
        order = [task.name for task in scenario.tasks]
        missing = session.progress.missing_before(trainee, scenario.name, name, order)
        return self.say("experiment.order", task=session.task_title(missing)) if missing else ""

    def _step(self) -> StudyStep | None:
        return self.session.study.step_of(self.session.trainee.strip())

    def _answer(self) -> None:
        try:
            self.session.pages.open(QuestionnairePage(self.session, self._step()))
        except InputError as error:
            self.session.complain(str(error))

    def _begin(self, task: str) -> None:
        session = self.session
        trainee = session.trainee.strip()
        session.do(CommandName.START_TASK, {"task": task, "trainee": trainee, "mode": session.mode})
