"""What all pages share: who trains, what is chosen, and what the simulator can do for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.command_arguments import check_arguments
from rastrainer.errors import InputError
from rastrainer.journal.folder import journals_of
from rastrainer.procedure.geometry import BoneAhead
from rastrainer.protocol import OPEN_PHASES, TRIAL_RUN, CommandName, GhostRule, Guidance, Mode
from rastrainer.registration.methods import RegistrationMethod
from rastrainer.scenario.library import ListedScenario
from rastrainer.scenario.method_task import method_of, playable_methods
from rastrainer.scenario.scenario import Scenario
from rastrainer.study.curriculum.told_curriculum import ToldAssignment, ToldCurriculum
from rastrainer.study.protocol.study_step import StudyStep
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.settings import SimulationSettings
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.flow.session.commands import Commands
from rastrainer_simulator.flow.session.curricula import AssignmentWords, Curricula
from rastrainer_simulator.flow.session.instructor_lock import InstructorLock
from rastrainer_simulator.flow.session.open_pages import OpenPages
from rastrainer_simulator.flow.session.operator_device import OperatorDevice
from rastrainer_simulator.flow.session.own_score import OwnScore
from rastrainer_simulator.flow.session.preferences import (
    PREFERENCES_FILE,
    Preferences,
    faded_guidance,
    write_preferences,
)
from rastrainer_simulator.flow.session.screen_sticks import ScreenSticks
from rastrainer_simulator.flow.session.study_steps import StudySteps, step_sentence
from rastrainer_simulator.flow.session.trace_places import TracePlaces
from rastrainer_simulator.flow.session.trainee_history import (
    DoneTasks,
    FinishedTutorials,
    ScoreHistory,
)
from rastrainer_simulator.flow.session.trial_view import TrialView
from rastrainer_simulator.flow.tutorial.tutorial import Tutorial
from rastrainer_simulator.input.bindings import (
    BINDINGS_FILE,
    Bindings,
    write_bindings,
)
from rastrainer_simulator.input.controls import Controls
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.net.views.feedback_event import FeedbackEvent
from rastrainer_simulator.net.views.screen import ScreenMessage, Tone
from rastrainer_simulator.operator_input import OperatorInput
from rastrainer_simulator.ops.instructor_pin import PinGuesses
from rastrainer_simulator.ops.texts.texts import LANGUAGES, Texts
from rastrainer_simulator.record.beside_the_trial import TutorialOutcome
from rastrainer_simulator.replay.ghost import TrialGhost
from rastrainer_simulator.replay.recorded_trial import TrialLoading
from rastrainer_simulator.state import Answer, SimulationState, TrainingState
from rastrainer_simulator.vectors import Vector, vector
from rastrainer_simulator.viewpoint.orbit import Orbit

NOTICE_S = 5.0
REACHED_S = 20.0
"""How long a reached assignment is shown: it comes while the result is read."""
SET_UP_AFTER_S = 1.0
"""A simulation takes a second to make: who steps through the options shall not wait for each."""
TUTORIAL_VIEW = Orbit(zoom=1.7)
"""From farther away than a trial: the tip is seen where it starts, above the head."""


@dataclass(frozen=True)
class FlowServices:
    """What the flow needs of the process that it runs in.

    Attributes:
        config: folder of the settings files.
        records: folder of the trials' journals.
        use_settings: has the simulation continue with other settings, between two trials.
        list_scenarios: lists the scenarios that `use_scenario` takes by their names.
        use_scenario: has the simulation continue with another scenario, between two trials.
        is_slicer_connected: says whether a client that registers and scores is connected.
        quit: ends the process.
        study: knows what a study that Slicer leads asks of the trainees.
        curricula: knows where trainees stand in their curricula.
        scores_alone: whether a trial outside of a study is scored here where no Slicer is
            connected.
        pin: the instructor's; None where there is never one.
        languages: tags of those that can be chosen: the window may lack the letters of others.
    """

    config: Path
    records: Path
    use_settings: Callable[[SimulationSettings], Future[Answer]]
    list_scenarios: Callable[[], Future[list[ListedScenario]]]
    use_scenario: Callable[[str], Future[Answer]]
    is_slicer_connected: Callable[[], bool]
    quit: Callable[[], None]
    study: StudySteps = field(default_factory=StudySteps)
    curricula: Curricula = field(default_factory=Curricula)
    scores_alone: bool = False
    pin: PinGuesses | None = None
    languages: Sequence[str] = tuple(LANGUAGES)


class TrainingSession:
    """The trainee's choices and the services behind the pages.

    Attributes:
        trainee: what was typed as the trainee's ID.
        mode: "desktop" or "hmd".
        procedure: name of the one that is to follow the touches; "" for the touches alone.
        method: by which the trial is registered, where the head allows it.
        has_read_introduction: whether the pages before the experiment menu can be skipped.
        preferences: what is chosen in the settings.
        texts: say everything in the chosen language.
        progress: which tasks each trainee has done.
        history: each trainee's earlier scores.
        own_score: scores a trial where no Slicer does; None where only Slicer may.
        pages: which are open.
        happened: gives feedback by sound and vibration.
        list_scenarios: lists the heads to train on.
        is_slicer_connected: says whether Slicer is connected.
        quit: ends the simulator.
        study: knows what a study asks of each trainee next.
        view: where the pictures of the trial are looked from.
        ghost: an earlier trial that moves beside the arm.
        tutorial: the one that is open; else None.
        tutorials: who has finished one, and with which device.
        screen_sticks: those that views draw for a mouse.
        lock: what needs the instructor's PIN.
        languages: those that can be chosen.
    """

    def __init__(
        self,
        control_loop: ControlLoop,
        controls: Controls,
        services: FlowServices,
        preferences: Preferences,
        happened: Callable[[FeedbackEvent], None],
    ) -> None:
        self.trainee = ""
        self.mode = Mode.DESKTOP.value
        self.procedure = ""
        self.method = RegistrationMethod.FIDUCIALS
        self.has_read_introduction = False
        self.preferences = preferences
        self.texts = Texts(LANGUAGES[preferences.language])
        self.progress = DoneTasks(services.records)
        self.history = ScoreHistory(services.records, self.progress.journals)
        self.own_score = (
            OwnScore(
                control_loop.submit,
                services.records,
                services.is_slicer_connected,
                self.history.of,
            )
            if services.scores_alone
            else None
        )
        self.happened = happened
        self.pages = OpenPages(happened)
        self.view = TrialView()
        self.ghost = TrialGhost()
        self.places = TracePlaces()
        self.tutorial: Tutorial | None = None
        self.tutorials = FinishedTutorials(services.records)
        self.screen_sticks = ScreenSticks()
        self.lock = InstructorLock(services.pin)
        self.languages = services.languages
        self.list_scenarios = services.list_scenarios
        self.is_slicer_connected = services.is_slicer_connected
        self.quit = services.quit
        self.study = services.study
        self._services = services
        self._control_loop = control_loop
        self._controls = controls
        self._commands = Commands(control_loop.submit, self._refused)
        self._wanted_settings: SimulationSettings | None = None
        self._set_up_in = 0.0
        self._setting_up: Future[Answer] | None = None
        self._time = 0.0
        self._notices: list[tuple[float, ScreenMessage]] = []
        self._told: ToldCurriculum | None = None
        self.state: SimulationState = control_loop.latest

    @property
    def training(self) -> TrainingState:
        """Where the trial stands."""
        return self.state.training

    @property
    def has_open_trial(self) -> bool:
        """Whether a trial can still be changed."""
        return self.training.phase in OPEN_PHASES

    @property
    def tip(self) -> Vector:
        """Where the tool's tip is, World, m."""
        return tuple(self.state.tool_tip_to_world[:3, 3].tolist())

    @property
    def setup(self) -> SimulationSetup:
        """What the present simulation was made from."""
        return self._control_loop.setup

    @property
    def scenario(self) -> Scenario:
        """The head and the tasks."""
        return self.setup.scenario

    @property
    def bindings(self) -> Bindings:
        """Which input does what."""
        return self._controls.bindings

    @property
    def held(self) -> OperatorInput:
        """How the operator's sticks stand."""
        return self._controls.held

    @property
    def operator(self) -> OperatorDevice:
        """What the operator works with, and what its inputs are called."""
        return OperatorDevice(self._controls, self.texts, self.mode, self.screen_sticks.is_shown)

    @property
    def is_being_set_up(self) -> bool:
        """Whether other settings of the simulation, or another scenario, are on their way."""
        return self._setting_up is not None or self._wanted_settings is not None

    @property
    def curriculum(self) -> ToldCurriculum | None:
        """Where the trainee stands in a curriculum.

        None without one, in a study, which comes before it, and while no Slicer is connected.
        """
        trainee = self.trainee.strip()
        if self.study.step_of(trainee) is not None or not self.is_slicer_connected():
            return None
        return self._services.curricula.of(trainee)

    @property
    def next_assignment(self) -> ToldAssignment | None:
        """The assignment to practice next; None where no open one is left, or no curriculum."""
        told = self.curriculum
        return None if told is None else told.find(told.next)

    @property
    def assignment_words(self) -> AssignmentWords:
        """What says of assignments what trainees read."""
        return AssignmentWords(self.texts, self.task_title, self.procedure_title)

    @property
    def does_view_follow(self) -> bool:
        """Whether the view goes automatically to the best view of each next point."""
        if (self.training if self.tutorial is None else self.tutorial).mode == Mode.HMD.value:
            # In a headset one looks around with the head.
            return False
        if self.tutorial is not None and not self.tutorial.has_learned_view:
            return False
        choice = self.preferences.view
        trainee = self.training.trainee if self.tutorial is None else self.tutorial.trainee
        is_led = self.study.step_of(trainee) is not None
        return choice == "always" or (choice == "practice" and not is_led)

    def advance(self, dt: float, state: SimulationState) -> None:
        """Take the newest state, and what has been answered within `dt` seconds."""
        self._time += dt
        self.state = state
        self.places.advance(dt, state)
        trial_id = self.training.trial_id
        self.lock.follow(self.trainee.strip(), trial_id, self.tutorial is not None)
        if self.own_score is not None:
            is_in_study = self.study.step_of(self.training.trainee) is not None
            self.own_score.advance(dt, self.training, self.scenario, is_in_study)
        self._commands.poll()
        self._note_reached()
        self._set_up_in -= dt
        if self._setting_up is not None and self._setting_up.done():
            answer = self._setting_up.result()
            self._setting_up = None
            if not answer.ok:
                self.complain(answer.message)
        may_set_up = self._setting_up is None and self._set_up_in <= 0.0
        if self._wanted_settings is not None and may_set_up and not self.has_open_trial:
            self._setting_up = self._services.use_settings(self._wanted_settings)
            self._wanted_settings = None

    def do(self, command: str, arguments: Mapping[str, Any] | None = None) -> None:
        """Have a command carried out."""
        holder = self._controls.holder
        sender = "" if holder is None else holder.kind.value
        try:
            self._commands.do(command, sender, arguments or {})
        except InputError as error:
            self.complain(str(error))

    def begin_tutorial(self) -> None:
        """Open the tutorial, in place of any page."""
        task = {"task": TRIAL_RUN, "trainee": self.trainee.strip(), "mode": self.mode}
        try:
            arguments = check_arguments(CommandName.START_TASK, task)
        except InputError as error:
            self.complain(str(error))
            return
        self.tutorial = Tutorial(self.setup, self.state, arguments, self.texts)
        practice = self.tutorial.practice
        self.view.begin(self.setup, practice.truth, practice.shown(self.state))
        self.view.control.go(TUTORIAL_VIEW)
        self.pages.show(None)

    def end_tutorial(self) -> TutorialOutcome | None:
        """Leave the tutorial; if all of it is done, keep its outcome and return it."""
        tutorial, self.tutorial = self.tutorial, None
        if tutorial is None:
            return None
        self.view.close()
        if tutorial.step is not None:
            return None
        outcome = tutorial.outcome(self.operator.learned)
        self._save(lambda: self.tutorials.keep(outcome))
        return outcome

    def start_task(self, task: str) -> None:
        """Have a trial of a task begun by the trainee, in the chosen mode."""
        trainee = self.trainee.strip()
        start = {"task": task, "trainee": trainee, "mode": self.mode}
        chosen = {"procedure": self.procedure_of(task), "method": self.method_of(task).value}
        step = self.study.step_of(trainee)
        skin = {"skin": dict(step.skin)} if step is not None and step.skin else {}
        self.do(CommandName.START_TASK, {**start, **chosen, **skin})

    def procedure_of(self, task: str) -> str:
        """Return the name of the procedure that follows the touches of a task; "" for none.

        A study says which; else it is the one that the trainee has chosen. The trial run has none.
        """
        step = self.study.step_of(self.trainee.strip())
        if step is not None:
            return step.procedure
        names = [each.name for each in self.scenario.procedures]
        return self.procedure if self.procedure in names and task != TRIAL_RUN else ""

    def method_of(self, task: str) -> RegistrationMethod:
        """Return by what a trial of a task is registered.

        A study says which; else it is what the trainee has chosen, if the head allows that. In the
        trial run it is fiducials.
        """
        step = self.study.step_of(self.trainee.strip())
        if step is not None:
            return method_of(step.method)
        return self.offered_method if task != TRIAL_RUN else RegistrationMethod.FIDUCIALS

    @property
    def offered_method(self) -> RegistrationMethod:
        """The chosen method; fiducials where the head does not allow it."""
        is_offered = self.method in playable_methods(self.scenario)
        return self.method if is_offered else RegistrationMethod.FIDUCIALS

    def prefer(self, preferences: Preferences) -> None:
        """Take on other preferences and save them."""
        before = self._control_loop.setup.settings
        self.preferences = preferences
        self.texts = Texts(LANGUAGES[preferences.language])
        wanted = preferences.applied_to(before)
        is_needed = wanted != before or self._setting_up is not None
        self._wanted_settings = wanted if is_needed else None
        self._set_up_in = SET_UP_AFTER_S
        path = self._services.config / PREFERENCES_FILE
        self._save(lambda: write_preferences(path, preferences))

    def fiducial(self, label: str) -> Vector:
        """Return where a fiducial of the present trial is, World, m: only after the score."""
        return self.truly_in_world(self._control_loop.truth.fiducials[label])

    def truly_in_world(self, point: np.ndarray) -> Vector:
        """Return where a point of the MRI (RAS mm) truly is, World, m: only after the score."""
        return vector((self._control_loop.truth.in_world(point) / MM_PER_M).tolist())

    @property
    def planned_bone(self) -> tuple[BoneAhead | None, ...]:
        """Where the lines of the present trial's procedure go through bone, as planned."""
        procedure = self.training.procedure
        assert procedure is not None, "the trial has a procedure"
        return self._control_loop.planned_bone.get(procedure.name, ())

    def use_scenario(self, name: str) -> None:
        """Continue with another scenario, as soon as it is loaded."""
        if not self.is_being_set_up:
            self._setting_up = self._services.use_scenario(name)

    def load_trial(self) -> TrialLoading:
        """Begin to load the present trial from its journal.

        Raises:
            InputError: the journal is not there any more.
        """
        found = journals_of(self._services.records, self.training.trial_id)
        if not found:
            raise InputError(self.texts.say("replay.no journal"))
        return TrialLoading(found[0], self._control_loop.setup)

    def guidance(self) -> Guidance:
        """Return how the trainee is guided in the present trial, by the study or the setting."""
        training, step = self.training, self.study.step_of(self.training.trainee)
        choice = step.guidance if step is not None and step.guidance else self.preferences.guidance
        order = [task.name for task in self.scenario.tasks]
        return faded_guidance(choice, training.task, order)

    def begin_ghost(self, head_to_world: np.ndarray) -> None:
        """Begin to load the ghost of the present trial; in a study only where its protocol has one.

        HeadToWorld is that of the trial, (4, 4) float, mm.
        """
        training, step = self.training, self.study.step_of(self.training.trainee)
        choice = self.preferences.ghost if step is None else step.ghost
        # Trial runs are not scored: there is no best one. Elsewhere, a ghost would lead to points.
        is_none = not choice or training.task == TRIAL_RUN or not training.is_marked
        rule = GhostRule.OFF if is_none else GhostRule(choice)
        who = training.trainee if rule is GhostRule.OWN else self.preferences.expert
        journals = () if rule is GhostRule.OFF else self.history.best(who, training.task)
        self.ghost.begin(rule, journals, training.trial_id, self.setup, head_to_world)

    def note_done(self) -> None:
        """Count the present trial's task as done."""
        self.progress.note(self.training.trainee, self.scenario.name, self.training.task)

    def rebind(self, bindings: Bindings) -> None:
        """Take on other bindings and save them."""
        self._controls.bindings = bindings
        path = self._services.config / BINDINGS_FILE
        self._save(lambda: write_bindings(path, bindings))

    def notice(self, text: str, tone: Tone = Tone.PLAIN, seconds: float = NOTICE_S) -> None:
        """Show a sentence for some seconds."""
        self._notices = [each for each in self._notices if each[1].text != text]
        self._notices.append((self._time + seconds, ScreenMessage(text, tone)))

    def complain(self, text: str) -> None:
        """Say what went wrong."""
        self.notice(self.texts.again(text), Tone.ERROR)
        self.happened(FeedbackEvent.ERROR)

    def notices(self) -> tuple[ScreenMessage, ...]:
        """Return the sentences that are still to be shown."""
        self._notices = [each for each in self._notices if each[0] > self._time]
        return tuple(message for _, message in self._notices)

    def task_title(self, name: str) -> str:
        """Return what people call a task."""
        key = f"task.{name}"
        if key in self.texts:
            return self.texts.say(key)
        titles = {task.name: task.title for task in self.scenario.tasks}
        return titles.get(name, name)

    def procedure_title(self, name: str) -> str:
        """Return what people call a procedure; "" is the touches alone."""
        titles = {each.name: each.title for each in self.scenario.procedures}
        return titles.get(name, name) if name else self.texts.say("experiment.touches alone")

    def step_sentence(self, step: StudyStep) -> str:
        """Return the sentence about a study's step."""
        left = self.study.break_left_s(step.trainee)
        return step_sentence(self.texts, step, self.task_title(step.task), self.duration(left))

    def duration(self, seconds: float) -> str:
        """Return minutes and seconds, such as 03:21."""
        whole = int(seconds)
        return f"{whole // 60:02d}:{whole % 60:02d}"

    def _note_reached(self) -> None:
        """Say which assignment the trainee has reached since Slicer told of it before."""
        before, self._told = self._told, self.curriculum
        if before is None or self._told is None or before is self._told:
            return
        for each in self._told.assignments:
            earlier = before.find(each.name) if before.trainee == self._told.trainee else None
            if each.is_reached and earlier is not None and not earlier.is_reached:
                title = self.assignment_words.title(each)
                said = self.texts.say("assignments.just reached", assignment=title)
                self.notice(said, Tone.GOOD, REACHED_S)

    def _save(self, write: Callable[[], None]) -> None:
        try:
            write()
        except InputError as error:
            self.complain(str(error))

    def _refused(self, command: str, sentence: str) -> None:
        # A touch that does not count comes as an event of its own, with its own sound.
        if command != CommandName.CAPTURE:
            self.complain(sentence)
