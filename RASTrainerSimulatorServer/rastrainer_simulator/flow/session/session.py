"""The state that all pages share: the trainee, the choices, and the simulator's services."""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from rastrainer import transforms
from rastrainer.commands import CommandName, check_arguments
from rastrainer.errors import InputError, RASTrainerError
from rastrainer.journal.folder import journals_of
from rastrainer.number_text import clock
from rastrainer.procedure.geometry import BoneAhead
from rastrainer.protocol import (
    DECIDE,
    OPEN_PHASES,
    TRIAL_RUN,
    AssignmentState,
    Mode,
    RegistrationMethod,
)
from rastrainer.scenario.scenario import Scenario
from rastrainer.study.protocol.questionnaires import QUESTIONNAIRES
from rastrainer.study_messages import CurriculumMessage, StudyStep
from rastrainer_simulator.decision.drill import Drill, begin_drill, continue_drill, continues_on
from rastrainer_simulator.flow.session.assigned_training import AssignmentTexts
from rastrainer_simulator.flow.session.open_pages import OpenPages, Page
from rastrainer_simulator.flow.session.operator_device import OperatorDevice
from rastrainer_simulator.flow.session.preferences import (
    PREFERENCES_FILE,
    InstructorLock,
    Preferences,
    write_preferences,
)
from rastrainer_simulator.flow.session.services import FlowServices, SimulationReload
from rastrainer_simulator.flow.session.trace_places import TracePlaces
from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from rastrainer_simulator.flow.session.tutorial import Tutorial
from rastrainer_simulator.input.bindings import BINDINGS_FILE, Bindings, write_bindings
from rastrainer_simulator.input.controls import Controls
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent, feedback_event
from rastrainer_simulator.presentation.screen import Notices, ScreenMessage, Tone
from rastrainer_simulator.record.trial_context import TutorialOutcome
from rastrainer_simulator.replay.ghost import TrialGhost
from rastrainer_simulator.replay.recorded_trial import TrialLoading, load_trial
from rastrainer_simulator.state import Answer, Event, SimulationState, TouchStage, TrainingState
from rastrainer_simulator.texts.texts import LANGUAGES, Texts
from rastrainer_simulator.training.local_scorer import LocalScorer
from rastrainer_simulator.trial_state import ProcedureState
from rastrainer_simulator.vectors import Vector, in_meters
from rastrainer_simulator.viewpoint.trial_view import TrialView
from rastrainer_simulator.viewpoint.view_control import Orbit

if TYPE_CHECKING:
    from rastrainer_simulator.decision.cases import DecisionCase

_log = logging.getLogger(__name__)

REACHED_S = 20.0
"""How long a reached assignment is shown: it comes while the result is read."""
HURRY_S = 20.0
"""Time left for a case at which the clock begins to warn."""
TUTORIAL_VIEW = Orbit(zoom=1.7)
"""Farther away than in a trial: the tip starts above the head and must be visible."""


@dataclass(eq=False, repr=False)
class TrainingSession:
    """The trainee's choices and the services behind the pages.

    Attributes:
        mode: "desktop" or "hmd".
        picture_share: how much of its picture the trainee's view has, 0 to 1, while it is awaited;
            else None.
        goes_on_blind: the trial that the trainee wants to go on without its picture; "" for none.
        practiced: task and point of the latest practice; no point for the tutorial.
        simulated_s: simulated time since the previous `advance`.
    """

    control_loop: ControlLoop
    controls: Controls
    services: FlowServices
    preferences: Preferences
    happened: Callable[[FeedbackEvent], None]
    trainee: str = ""
    mode: str = Mode.DESKTOP.value
    procedure: str = ""
    method: RegistrationMethod = RegistrationMethod.FIDUCIALS
    has_read_introduction: bool = False
    tutorial: Tutorial | None = None
    drill: Drill | None = None
    practiced: tuple[str, str] = TRIAL_RUN, ""
    picture_share: float | None = None
    goes_on_blind: str = ""
    view: TrialView = field(default_factory=TrialView)
    ghost: TrialGhost = field(default_factory=TrialGhost)
    places: TracePlaces = field(default_factory=TracePlaces)
    notices: Notices = field(default_factory=Notices)
    _asked: list[tuple[str, Future[Answer]]] = field(default_factory=list)
    _noted: CurriculumMessage | None = None

    def __post_init__(self) -> None:
        services, loop = self.services, self.control_loop
        self.texts = Texts(LANGUAGES[self.preferences.language])
        self.history = TraineeHistory(services.records)
        scoring = loop.submit, services.records, services.is_slicer_connected, self.history.own
        self.local_scorer = LocalScorer(*scoring) if services.scores_alone else None
        self.pages = OpenPages(self.happened)
        self.operator = OperatorDevice(self.controls, self.texts)
        self.lock = InstructorLock(services.pin)
        self.reload = SimulationReload(services, loop, self.complain)
        self.state: SimulationState = loop.latest
        self.simulated_s = 0.0

    def say(self, key: str, **values: object) -> str:
        return self.texts.say(key, **values)

    @property
    def training(self) -> TrainingState:
        return self.state.training

    @property
    def trainee_id(self) -> str:
        """The trainee's ID without the spaces that may have been typed around it."""
        return self.trainee.strip()

    @property
    def step(self) -> StudyStep | None:
        return self.services.assigned.steps.get(self.trainee_id)

    @property
    def trial_step(self) -> StudyStep | None:
        return self.services.assigned.steps.get(self.training.trainee)

    @property
    def has_open_trial(self) -> bool:
        return self.training.phase in OPEN_PHASES

    @property
    def scenario(self) -> Scenario:
        return self.control_loop.setup.scenario

    @property
    def curriculum(self) -> CurriculumMessage | None:
        """Where the trainee stands in a curriculum.

        None without one, in a study, which comes before it, and while no Slicer is connected.
        """
        assigned, trainee = self.services.assigned, self.trainee_id
        if trainee in assigned.steps or not self.services.is_slicer_connected():
            return None
        return assigned.curricula.get(trainee)

    @property
    def assignment_texts(self) -> AssignmentTexts:
        return AssignmentTexts(self.texts, self.task_title, self.procedure_title)

    def advance(self, dt: float, state: SimulationState) -> None:
        self.notices.advance(dt)
        self.simulated_s = max(0.0, state.sim_time - self.state.sim_time)
        self.state = state
        self.places.advance(dt, state)
        trial_id = self.training.trial_id
        self.lock.follow(self.trainee_id, trial_id, self.tutorial is not None)
        if self.local_scorer is not None:
            is_in_study = self.trial_step is not None
            self.local_scorer.advance(dt, self.training, self.scenario, is_in_study)
        asked, self._asked = self._asked, []
        for command, answer in asked:
            if not answer.done():
                self._asked.append((command, answer))
            # A touch that does not count comes as a separate event, with its own sound.
            elif not answer.result().ok and command != CommandName.CAPTURE:
                self.complain(answer.result().message)
        if self.drill is not None and self.picture_share is None:
            self._advance_drill(dt, self.drill)
        self._note_reached()
        self.reload.advance(dt, self.has_open_trial)

    def do(self, command: str, arguments: Mapping[str, Any] | None = None) -> None:
        holder = self.controls.holder
        sender = "" if holder is None else holder.kind.value
        checked = self._checked(command, arguments or {})
        if checked is not None:
            self._asked.append((command, self.control_loop.submit(command, checked, sender)))

    def move_tip(self, place_mm: list[float], speed_mm_s: float) -> None:
        self.do(CommandName.MOVE_TIP_TO, {"positionMm": place_mm, "speedMmS": speed_mm_s})

    def _checked(self, command: str, arguments: Mapping[str, Any]) -> dict[str, Any] | None:
        """Return checked arguments; the reason against them, which names a command, is logged."""
        try:
            return check_arguments(command, arguments)
        except InputError as error:
            _log.warning("%s", error)
            self.complain(self.say("warning.impossible"))
            return None

    def begin_tutorial(self, task: str = TRIAL_RUN, point: str = "") -> None:
        """Open the tutorial, or the practice of a task's point, in place of any page.

        It is recorded nowhere, and refused while its head is about to go.
        """
        if self.reload.is_under_way:
            self.complain(self.say("being set up"))
            return
        wanted = {"task": task, "trainee": self.trainee_id, "mode": self.mode}
        arguments, setup = self._checked(CommandName.START_TASK, wanted), self.control_loop.setup
        if arguments is not None:
            self.tutorial = Tutorial(setup, self.state, arguments, point)
            self.practiced = task, point
            self.view.begin(setup, self.tutorial.practice.shown(self.state))
            self.view.control.reset()
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
        outcome = tutorial.outcome(self.operator.learned(self.mode))
        if not tutorial.practiced:
            with self.complaining():
                self.history.keep_tutorial(outcome)
        return outcome

    @property
    def open_drill(self) -> Path | None:
        """The journal of the drill that the trainee has to continue on this scenario."""
        left, setup = self.history.left_drills(self.trainee_id), self.control_loop.setup
        return next((path for path, header in left if continues_on(header, setup)), None)

    def begin_drill(self) -> None:
        """Continue the trainee's drill, or begin one; then all that were left are abandoned."""
        self.leave_drill()
        if self.reload.is_under_way:
            self.complain(self.say("being set up"))
            return
        trainee, loop, history = self.trainee_id, self.control_loop, self.history
        seen = {case.seed for drill in history.drills(trainee) for case in drill.cases}
        with self.complaining():
            if (path := self.open_drill) is not None:
                self.drill = continue_drill(path, loop, seen)
                return
        with self.complaining():
            seed, records = self.services.draw_seed(), self.services.records
            self.drill = begin_drill(records, trainee, self.mode, loop, seed, seen)
            for left, header in history.left_drills(trainee):
                loop.write(partial(loop.archive.add_interrupted, left)).result()
                history.drill_changed(header.trial_id)
                told = self.say("decide.abandoned", scenario=header.scenario.name)
                self.notices.add(told, Tone.WARNING)
            history.drill_changed(self.drill.trial_id)

    @property
    def placed_case(self) -> DecisionCase:
        """The present case of the open drill, with the head where the last trial has left it."""
        assert self.drill is not None, "It is asked for while there is a drill."
        case, pose = self.drill.case, self.control_loop.simulation.truth.head_to_world
        to_case = case.head_to_world @ transforms.inverse(pose)
        return replace(case, head_to_world=pose, registration=case.registration @ to_case)

    @property
    def drill_clock(self) -> ScreenMessage | None:
        """The time left for the present case of a drill; None without one."""
        drill = self.drill
        if drill is None or not drill.is_ready or drill.decided is not None:
            return None
        # Rounding first: an error in a float's last digit must not add a second.
        left = math.ceil(round(drill.left_s, 6))
        hurry = Tone.WARNING if left else Tone.ERROR
        return ScreenMessage(clock(left), hurry if left <= HURRY_S else Tone.PLAIN)

    def leave_drill(self) -> None:
        """Leave the drill, to be continued with its present clock."""
        drill, self.drill = self.drill, None
        if drill is not None:
            drill.close()
            self.history.drill_changed(drill.trial_id)

    def _advance_drill(self, dt: float, drill: Drill) -> None:
        was_finished = drill.is_finished
        with self.complaining():
            drill.advance(dt)
        if drill.is_finished and not was_finished:
            self.history.drill_changed(drill.trial_id)
            self.services.assigned.note_registered(drill.trainee, DECIDE, drill.header.mode)

    def prefer(self, **changes: Any) -> None:
        before = self.control_loop.setup.settings
        self.preferences = preferences = replace(self.preferences, **changes)
        self.texts = self.operator.texts = Texts(LANGUAGES[preferences.language])
        self.reload.request(before, preferences.applied_to(before))
        with self.complaining():
            write_preferences(self.services.config / PREFERENCES_FILE, preferences)

    def truly_in_world(self, point: np.ndarray) -> Vector:
        """Return where a point of the MRI (RAS mm) truly is, World, m: only after the score."""
        return in_meters(self.control_loop.simulation.truth.in_world(point))

    def bone_ahead(self, procedure: ProcedureState) -> BoneAhead | None:
        """Return the bone on the current line of a procedure, as planned."""
        planned = self.control_loop.simulation.planned_bone.get(procedure.name, ())
        return planned[procedure.trajectory] if procedure.trajectory < len(planned) else None

    def load_trial(self, trial_id: str) -> TrialLoading:
        found = journals_of(self.services.records, trial_id)
        if not found:
            raise InputError(self.say("replay.no journal"))
        return load_trial(found[0], self.control_loop.setup)

    def note_done(self) -> None:
        self.history.done[self.training.trainee, self.scenario.name].add(self.training.task)

    def outcome_of(self, task: str) -> str:
        """Return "passed", "failed" or "done" of the trainee's trials of a task; "" of none."""
        trainee, scenario = self.trainee_id, self.scenario.name
        own = self.history.own(trainee)
        trials = [each for each in own if (each.task, each.scenario) == (task, scenario)]
        if any(each.is_passed for each in trials):
            return "passed"
        if trials and trials[-1].is_passed is False:
            return "failed"
        return "done" if task in self.history.done[trainee, scenario] else ""

    def rebind(self, bindings: Bindings) -> None:
        self.controls.bindings = bindings
        with self.complaining():
            write_bindings(self.services.config / BINDINGS_FILE, bindings)

    @contextmanager
    def complaining(self) -> Iterator[None]:
        try:
            yield
        except RASTrainerError as error:
            # Not str(error), which is not said again in the trainee's language.
            self.complain(error.args[0])

    def feel(self, events: Iterable[Event], touch: TouchStage, not_recorded: bool = False) -> None:
        """Give the feedback to events, as `feedback_event` has it."""
        for event in events:
            felt = feedback_event(event, touch, not_recorded)
            if felt is not None:
                self.happened(felt)

    def complain(self, text: str) -> None:
        self.notices.add(self.texts.again(text), Tone.ERROR)
        self.happened(FeedbackEvent.ERROR)

    def task_title(self, name: str) -> str:
        key = f"task.{name}"
        if key in self.texts:
            return self.say(key)
        titles = {task.name: task.title for task in self.scenario.tasks}
        return titles.get(name, name)

    def procedure_title(self, name: str) -> str:
        titles = {each.name: each.title for each in self.scenario.procedures}
        return titles.get(name, name) if name else self.say("experiment.touches alone")

    @property
    def practice_title(self) -> str:
        task, point = self.practiced
        key = "tutorial.practice" if point else "tutorial.title"
        return self.say(key, task=self.task_title(task), point=point)

    def preparing(self) -> str:
        share = self.picture_share
        key = "preparing.loaded" if share else "preparing.built"
        return "" if share is None else self.say(key, share=100.0 * share)

    def step_sentence(self, step: StudyStep) -> str:
        asked = QUESTIONNAIRES.get(step.questionnaire)
        task, by = self.task_title(step.task), f"study.by {step.method}"
        return self.say(
            f"study.{step.kind}",
            number=step.number,
            count=step.count,
            task=f"{task} {self.say(by)}" if by in self.texts else task,
            mode=self.say(f"study.{step.mode}") if step.mode else "",
            minutes=step.minutes,
            left=clock(self.services.assigned.break_left_s(step.trainee)),
            questionnaire=step.questionnaire if asked is None else asked.title,
        )

    def _note_reached(self) -> None:
        """Announce the assignment that the trainee has reached since Slicer's last message."""
        before, now = self._noted, self.curriculum
        self._noted = now
        if before is None or now is None or before.trainee != now.trainee:
            return
        for each in now.assignments:
            earlier = before.find(each.name)
            is_new = earlier is not None and earlier.state is not AssignmentState.REACHED
            if each.state is AssignmentState.REACHED and is_new:
                title = self.assignment_texts.title(each)
                said = self.say("assignments.just reached", assignment=title)
                self.notices.add(said, Tone.GOOD, REACHED_S)


SessionPage = Page[TrainingSession]
"""A page of a trainee's session."""
