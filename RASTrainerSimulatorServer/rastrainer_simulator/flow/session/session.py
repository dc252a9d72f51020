"""What all pages share: who trains, what is chosen, and what the simulator can do for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from concurrent.futures import Future
from typing import Any

import numpy as np

from rastrainer.command_arguments import check_arguments
from rastrainer.errors import InputError
from rastrainer.journal.folder import journals_of
from rastrainer.procedure.geometry import BoneAhead
from rastrainer.protocol import OPEN_PHASES, TRIAL_RUN, CommandName, Mode, RegistrationMethod
from rastrainer.scenario.scenario import Scenario
from rastrainer.study_messages import AssignmentStanding, CurriculumMessage, StudyStep
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.flow.session.assigned_training import (
    AssignmentTexts,
    newly_reached,
    step_sentence,
)
from rastrainer_simulator.flow.session.open_pages import OpenPages
from rastrainer_simulator.flow.session.operator_device import OperatorDevice, ScreenSticks
from rastrainer_simulator.flow.session.own_score import OwnScore
from rastrainer_simulator.flow.session.preferences import (
    PREFERENCES_FILE,
    InstructorLock,
    Preferences,
    write_preferences,
)
from rastrainer_simulator.flow.session.services import FlowServices, SettingUp
from rastrainer_simulator.flow.session.trace_places import TracePlaces
from rastrainer_simulator.flow.session.trainee_history import (
    DoneTasks,
    FinishedTutorials,
    ScoreHistory,
)
from rastrainer_simulator.flow.session.trial_view import TrialView
from rastrainer_simulator.flow.tutorial.tutorial import Tutorial
from rastrainer_simulator.input.bindings import BINDINGS_FILE, Bindings, write_bindings
from rastrainer_simulator.input.controls import Controls
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.screen import Notices, Tone
from rastrainer_simulator.record.trial_context import TutorialOutcome
from rastrainer_simulator.replay.ghost import TrialGhost
from rastrainer_simulator.replay.recorded_trial import TrialLoading, load_trial
from rastrainer_simulator.state import Answer, OperatorInput, SimulationState, TrainingState
from rastrainer_simulator.texts.texts import LANGUAGES, Texts
from rastrainer_simulator.vectors import Vector, in_meters
from rastrainer_simulator.viewpoint.view_control import Orbit

REACHED_S = 20.0
"""How long a reached assignment is shown: it comes while the result is read."""
TUTORIAL_VIEW = Orbit(zoom=1.7)
"""From farther away than a trial: the tip is seen where it starts, above the head."""


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
        quit: ends the simulator.
        study: knows what a study asks of each trainee next.
        view: where the pictures of the trial are looked from.
        ghost: an earlier trial that moves beside the arm.
        tutorial: the one that is open; else None.
        tutorials: who has finished one, and with which device.
        screen_sticks: those that views draw for a mouse.
        layouts: what is written on the keys of each view, by their W3C codes.
        lock: what needs the instructor's PIN.
        notices: what is said beside the instruction.
        picture_share: how much of its picture the trainee's view has, 0 to 1, while it is awaited;
            else None.
        goes_on_blind: the trial that the trainee wants to go on without its picture; "" for none.
        setting_up: has the simulation continue with other settings, or on another head.
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
                control_loop.submit, services.records, services.is_slicer_connected, self.history.of
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
        self.layouts: dict[int, Mapping[str, str]] = {}
        self.lock = InstructorLock(services.pin)
        self.languages = services.languages
        self.list_scenarios = services.list_scenarios
        self.is_slicer_connected = services.is_slicer_connected
        self.quit = services.quit
        self.study = services.study
        self.setting_up = SettingUp(services, control_loop, self.complain)
        self._services = services
        self._control_loop = control_loop
        self._controls = controls
        self._asked: list[tuple[str, Future[Answer]]] = []
        self._practiced = TRIAL_RUN, ""
        self.notices = Notices()
        self.picture_share: float | None = None
        self.goes_on_blind = ""
        self._noted: CurriculumMessage | None = None
        self.state: SimulationState = control_loop.latest

    @property
    def training(self) -> TrainingState:
        return self.state.training

    @property
    def has_open_trial(self) -> bool:
        """Whether a trial can still be changed."""
        return self.training.phase in OPEN_PHASES

    @property
    def tip(self) -> Vector:
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
        """The deflection of the operator's sticks."""
        return self._controls.held

    @property
    def operator(self) -> OperatorDevice:
        """The operator's device, and the names of its inputs."""
        has_sticks = self.screen_sticks.is_shown
        return OperatorDevice(self._controls, self.texts, self.mode, has_sticks, self.layouts)

    @property
    def curriculum(self) -> CurriculumMessage | None:
        """Where the trainee stands in a curriculum.

        None without one, in a study, which comes before it, and while no Slicer is connected.
        """
        trainee = self.trainee.strip()
        if self.study.step_of(trainee) is not None or not self.is_slicer_connected():
            return None
        return self._services.curricula.of(trainee)

    @property
    def next_assignment(self) -> AssignmentStanding | None:
        """The assignment to practice next; None where no open one is left, or no curriculum."""
        curriculum = self.curriculum
        return None if curriculum is None else curriculum.find(curriculum.next)

    @property
    def assignment_texts(self) -> AssignmentTexts:
        """Describes assignments for trainees."""
        return AssignmentTexts(self.texts, self.task_title, self.procedure_title)

    def advance(self, dt: float, state: SimulationState) -> None:
        """Process the newest state, and the answers of the last `dt` seconds."""
        self.notices.advance(dt)
        self.state = state
        self.places.advance(dt, state)
        trial_id = self.training.trial_id
        self.lock.follow(self.trainee.strip(), trial_id, self.tutorial is not None)
        if self.own_score is not None:
            is_in_study = self.study.step_of(self.training.trainee) is not None
            self.own_score.advance(dt, self.training, self.scenario, is_in_study)
        self._take_answers()
        self._note_reached()
        self.setting_up.advance(dt, self.has_open_trial)

    def do(self, command: str, arguments: Mapping[str, Any] | None = None) -> None:
        """Have a command carried out."""
        holder = self._controls.holder
        sender = "" if holder is None else holder.kind.value
        try:
            checked = check_arguments(command, arguments or {})
        except InputError as error:
            self.complain(str(error))
        else:
            self._asked.append((command, self._control_loop.submit(command, checked, sender)))

    def begin_tutorial(self) -> None:
        """Open the tutorial, in place of any page, unless its head is about to go."""
        self.begin_practice(TRIAL_RUN)

    def begin_practice(self, task: str, point: str = "") -> None:
        """Open the practice of a task's point, recorded nowhere; without one the tutorial."""
        if self.setting_up.is_under_way:
            self.complain(self.texts.say("being set up"))
            return
        wanted = {"task": task, "trainee": self.trainee.strip(), "mode": self.mode}
        try:
            arguments = check_arguments(CommandName.START_TASK, wanted)
        except InputError as error:
            self.complain(str(error))
            return
        self.tutorial = Tutorial(self.setup, self.state, arguments, self.texts, point)
        self._practiced = task, point
        practice = self.tutorial.practice
        self.view.begin(self.setup, practice.truth, practice.shown(self.state))
        self.view.control.go(TUTORIAL_VIEW)
        self.pages.show(None)

    def restart_practice(self) -> None:
        """Begin the latest practice or tutorial again."""
        self.begin_practice(*self._practiced)

    def end_tutorial(self) -> TutorialOutcome | None:
        """Leave the tutorial; if all of it is done, keep its outcome and return it."""
        tutorial, self.tutorial = self.tutorial, None
        if tutorial is None:
            return None
        self.view.close()
        if tutorial.step is not None:
            return None
        outcome = tutorial.outcome(self.operator.learned)
        if not tutorial.practiced:
            self._save(lambda: self.tutorials.keep(outcome))
        return outcome

    def prefer(self, preferences: Preferences) -> None:
        """Adopt other preferences and save them."""
        before = self._control_loop.setup.settings
        self.preferences = preferences
        self.texts = Texts(LANGUAGES[preferences.language])
        self.setting_up.want(before, preferences.applied_to(before))
        self._save(lambda: write_preferences(self._services.config / PREFERENCES_FILE, preferences))

    def fiducial(self, label: str) -> Vector:
        """Return where a fiducial of the present trial is, World, m: only after the score."""
        return self.truly_in_world(self._control_loop.truth.fiducials[label])

    def truly_in_world(self, point: np.ndarray) -> Vector:
        """Return where a point of the MRI (RAS mm) truly is, World, m: only after the score."""
        return in_meters(self._control_loop.truth.in_world(point))

    def planned_bone(self, procedure: str) -> tuple[BoneAhead | None, ...]:
        """Return where the lines of a procedure go through bone, as planned."""
        return self._control_loop.planned_bone.get(procedure, ())

    def load_trial(self, trial_id: str) -> TrialLoading:
        """Begin to load a trial from its journal."""
        found = journals_of(self._services.records, trial_id)
        if not found:
            raise InputError(self.texts.say("replay.no journal"))
        return load_trial(found[0], self._control_loop.setup)

    def note_done(self) -> None:
        """Count the present trial's task as done."""
        self.progress.note(self.training.trainee, self.scenario.name, self.training.task)

    def outcome_of(self, task: str) -> str:
        """Return "passed", "failed" or "done" of the trainee's trials of a task; "" of none."""
        trainee, scenario = self.trainee.strip(), self.scenario.name
        trials = [
            each
            for each in self.history.own(trainee)
            if (each.past.task, each.scenario) == (task, scenario)
        ]
        if any(each.is_passed for each in trials):
            return "passed"
        if trials and trials[-1].is_passed is False:
            return "failed"
        return "done" if self.progress.has_done(trainee, scenario, task) else ""

    def rebind(self, bindings: Bindings) -> None:
        self._controls.bindings = bindings
        self._save(lambda: write_bindings(self._services.config / BINDINGS_FILE, bindings))

    def complain(self, text: str) -> None:
        """Report a failure."""
        self.notices.add(self.texts.again(text), Tone.ERROR)
        self.happened(FeedbackEvent.ERROR)

    def task_title(self, name: str) -> str:
        """Return the title of a task."""
        key = f"task.{name}"
        if key in self.texts:
            return self.texts.say(key)
        titles = {task.name: task.title for task in self.scenario.tasks}
        return titles.get(name, name)

    def procedure_title(self, name: str) -> str:
        titles = {each.name: each.title for each in self.scenario.procedures}
        return titles.get(name, name) if name else self.texts.say("experiment.touches alone")

    @property
    def practice_title(self) -> str:
        task, point = self._practiced
        key = "tutorial.practice" if point else "tutorial.title"
        return self.texts.say(key, task=self.task_title(task), point=point)

    def preparing(self) -> str:
        """Return how far the awaited picture is; "" where none is awaited."""
        share = self.picture_share
        if share is None:
            return ""
        key = "preparing.loaded" if share > 0.0 else "preparing.built"
        return self.texts.say(key, share=100.0 * share)

    def step_sentence(self, step: StudyStep) -> str:
        left = self.study.break_left_s(step.trainee)
        return step_sentence(self.texts, step, self.task_title(step.task), self.duration(left))

    def duration(self, seconds: float) -> str:
        """Return minutes and seconds, such as 03:21."""
        whole = int(seconds)
        return f"{whole // 60:02d}:{whole % 60:02d}"

    def _note_reached(self) -> None:
        """Announce the assignment that the trainee has reached since Slicer's last message."""
        before, self._noted = self._noted, self.curriculum
        for each in newly_reached(before, self._noted):
            title = self.assignment_texts.title(each)
            said = self.texts.say("assignments.just reached", assignment=title)
            self.notices.add(said, Tone.GOOD, REACHED_S)

    def _save(self, write: Callable[[], None]) -> None:
        try:
            write()
        except InputError as error:
            self.complain(str(error))

    def _take_answers(self) -> None:
        """Show why answered commands were refused."""
        asked, self._asked = self._asked, []
        for command, answer in asked:
            if not answer.done():
                self._asked.append((command, answer))
            # A touch that does not count comes as a separate event, with its own sound.
            elif not answer.result().ok and command != CommandName.CAPTURE:
                self.complain(answer.result().message)
