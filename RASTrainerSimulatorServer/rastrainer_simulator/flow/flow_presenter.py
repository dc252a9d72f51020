"""The flow's presenter: controls, flow and feedback, as the views and the server see them."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.journal.entries import DisplayReport, ViewReport
from rastrainer.protocol import Mode
from rastrainer_simulator.flow.flow import Flow
from rastrainer_simulator.flow.operated_views import OperatedView, OperatedViews
from rastrainer_simulator.flow.pages.result import ResultPage
from rastrainer_simulator.flow.pages.trial_review import ReplayPage
from rastrainer_simulator.flow.session.preferences import Preferences
from rastrainer_simulator.flow.session.services import FlowServices
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.bindings import Bindings
from rastrainer_simulator.input.controls import IDLE_S, Controls, ControlsListener
from rastrainer_simulator.input.gamepads import w3c_gamepad_inputs
from rastrainer_simulator.input.inputs import (
    ControlContext,
    ControlName,
    InputDevice,
    Source,
    SourceKind,
    button_in_menu,
)
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.messages import Hello, InstructorOrder, Seat
from rastrainer_simulator.presentation.presenter import Control, Presenter, TraceGuidance
from rastrainer_simulator.presentation.screen import PRESS, Tone
from rastrainer_simulator.replay.playback import PlaybackSwitch
from rastrainer_simulator.state import (
    NEUTRAL_STICKS,
    Answer,
    OperatorInput,
    SimulationState,
    StepResult,
)
from rastrainer_simulator.viewpoint.view_control import Pictures

PICTURE_GRACE_S = 0.5
"""A picture that is there so soon is no reason to pause a trial."""
REFRESH_S = 0.1
"""How often a screen is rebuilt though nothing was pressed: its clock, distances and axes."""

SENTENCE_S = 20.0
"""How long the trainee sees a teacher's message: longer than a notice, as it is unexpected."""
NOTED_S = 0.2
"""How often a moving view is noted in the journal."""


class FlowPresenter(Presenter):
    """The presenter for one trainee.

    Everything but what the control loop calls belongs to one thread. `advance` is to be called
    some hundred times a second; nothing here waits.

    Attributes:
        rumble: has the simulator's gamepads vibrate with a strength of 0 to 1 for a time (s).
    """

    def __init__(
        self,
        control_loop: ControlLoop,
        services: FlowServices,
        bindings: Bindings,
        preferences: Preferences,
    ) -> None:
        super().__init__()
        self._control_loop = control_loop
        self.shown = PlaybackSwitch(control_loop)
        # Another operator may take control from an idle one, unless a PIN locks it.
        listener = ControlsListener(self.pressed, self.input_pressed, self.taken_over, self.refused)
        self.controls = Controls(bindings, listener, lambda: not self._session.lock.is_locked)
        self._session = TrainingSession(
            control_loop, self.controls, services, preferences, self._feel
        )
        self._flow = Flow(self._session)
        self.rumble: Callable[[float, float], None] = lambda _strength, _seconds: None
        self._newest = control_loop.latest
        # The control loop's thread adds a tick at one end, ours takes it from the other.
        self._ticks: deque[StepResult] = deque()
        self._views = OperatedViews()
        self._noted_view: tuple[str, ViewReport] | None = None
        self._since_noted_s = 0.0
        self._without_picture_s = 0.0
        self._sent_sticks = NEUTRAL_STICKS
        self._is_changed = True
        self._since_refresh = 0.0
        self.screen = self._flow.screen()
        self._unsubscribe = control_loop.subscribe(self._ticks.append)

    def close(self) -> None:
        self._unsubscribe()
        self._session.pages.show(None)
        self._session.leave_drill()
        self._session.view.close()
        self._session.ghost.close()
        self._session.places.close()
        self.shown.close()
        self._control_loop.hold_sticks(NEUTRAL_STICKS)

    def advance(self, dt: float) -> None:
        # A state ahead of its events would sound the alarm of a contact twice.
        while self._ticks:
            tick = self._ticks.popleft()
            self._newest = tick.state
            if tick.events:
                self._flow.process_tick(tick)
                self._is_changed = True
        self.controls.advance(dt)
        self._await_picture(dt)
        self._flow.advance(dt, self._newest)
        self._advance_view(dt)
        self._settle()
        self._since_refresh += dt
        if self._is_changed or self._since_refresh >= REFRESH_S:
            self._is_changed = False
            self._since_refresh = 0.0
            self.show(self._flow.screen())

    def pictures(self, now: SimulationState) -> Pictures:
        return self._session.view.pictures(now, self.shown.setup.scenario.cameras)

    def ghost(self, now: SimulationState) -> tuple[np.ndarray, ...] | None:
        return None if self._flow.playback is not None else self._session.ghost.poses(now)

    def trace_guidance(self, now: SimulationState) -> TraceGuidance:
        is_replayed = self._flow.playback is not None
        return TraceGuidance() if is_replayed else self._session.places.guidance(now)

    def seat(self) -> Seat:
        session, screen = self._session, self.screen
        training, curriculum = session.training, session.curriculum
        is_open = session.has_open_trial
        trainee = training.trainee if is_open else session.trainee_id
        scores = [trial.score for trial in session.history.own(trainee) if not trial.is_aborted]
        wrong = (each for each in screen.warnings if each.tone in (Tone.WARNING, Tone.ERROR))
        return Seat(
            trainee=trainee,
            task=session.task_title(training.task) if is_open else "",
            count=len(self._control_loop.simulation.truth.fiducials_ras) if is_open else 0,
            screen="" if screen.menu is None else screen.menu.title,
            instruction=screen.instruction.text,
            warnings=tuple(each.text for each in wrong),
            score=scores[-1] if scores else None,
            holder=self.control.holder,
            slicer=session.services.is_slicer_connected(),
            language=screen.language,
            assignments="" if curriculum is None else session.assignment_texts.in_brief(curriculum),
        )

    def instruct(self, order: InstructorOrder, text: str) -> str:
        say, page = self._session.say, self._session.pages.top
        is_practiced = self._session.tutorial is not None or self._session.drill is not None
        is_running = self._session.training.is_running or is_practiced
        problem = ""
        if order is InstructorOrder.SAY:
            self._session.notices.add(say("instructor.says", text=text), seconds=SENTENCE_S)
        elif order is InstructorOrder.PAUSE and (is_running or self._flow.playback is not None):
            self._flow.pause("unseen.instructor")
        elif order is InstructorOrder.PAUSE:
            problem = say("instructor.nothing runs")
        elif isinstance(page, ResultPage):
            page.show_again()
        elif not isinstance(page, ReplayPage):
            problem = say("instructor.no result")
        self._settle(is_changed=True)
        return problem

    def start_tutorial(self, trainee: str, mode: str) -> Answer:
        answer = self._flow.start_tutorial(trainee, mode)
        self._settle(is_changed=True)
        return answer

    def start_drill(self, trainee: str, mode: str) -> Answer:
        answer = self._flow.start_drill(trainee, mode)
        self._settle(is_changed=True)
        return answer

    def view_joined(self, view: int, hello: Hello) -> None:
        self._views.joined[view] = OperatedView(hello)
        self._choose_mode(hello)

    def view_left(self, view: int) -> None:
        """Forget a view; if it was the trainee's, no one sees the trial any more."""
        was_silent = self._views.watched(self.controls.holder) is None
        self._lose_sight(view, "unseen.left")
        self._session.operator.layouts.pop(view, None)
        left = self._views.joined.pop(view, None)
        if left is not None:
            self._choose_mode(left.hello)
        if was_silent and not self._views.joined:
            # The trial may wait for the picture of this view.
            self._flow.pause("unseen.left")
        self._settle()

    def receive(self, view: int, kind: str, *values: object) -> None:
        super().receive(view, kind, *values)
        self._settle()

    def on_key(self, view: int, code: str, is_down: bool, text: str) -> None:
        source = self._views.source(SourceKind.KEYBOARD, view)
        typed = self._session.pages.typed(code, text) if is_down else None
        if typed is None:
            self.controls.set_key(source, code, is_down)
            return
        if self.controls.allows(source):
            self._session.pages.write(*typed)
        self._is_changed = True

    def on_layout(self, view: int, keys: Mapping[str, str]) -> None:
        self._session.operator.layouts[view] = keys
        self._is_changed = True

    def on_pad(self, view: int, axes: Sequence[float], buttons: Sequence[float]) -> None:
        source = self._views.source(SourceKind.BROWSER_GAMEPAD, view)
        self.controls.set_inputs(source, w3c_gamepad_inputs(axes, buttons))

    def on_sticks(
        self,
        view: int,
        translation: tuple[float, float, float],
        rotation: tuple[float, float],
        is_fine: bool,
        yaw_deg: float,
    ) -> None:
        source = self._views.sticks_source(view, self._session.operator.screen_sticks.is_shown)
        if source.kind is SourceKind.XR and view in self._views.joined:
            self._views.joined[view].yaw_deg = yaw_deg
        sticks = OperatorInput(translation, rotation, is_fine)
        if source.kind is SourceKind.MOUSE:
            sticks = self._session.operator.screen_sticks.moved(translation, rotation)
        self.controls.set_sticks(source, sticks)

    def on_orbit(self, view: int, around_deg: float, higher_deg: float, zoom: float) -> None:
        if self.controls.is_operator(self._views.source(SourceKind.MOUSE, view)):
            camera = self.shown.setup.scenario.cameras[self.shown.latest.camera]
            self._session.view.control.turn(camera, around_deg, higher_deg, zoom)

    def on_press(self, view: int, control: str) -> None:
        name = button_in_menu(control)
        if name is None:
            return
        if self._session.pages.top is None:
            name = ControlName(control)
        self.controls.press(
            self._views.sticks_source(view, self._session.operator.screen_sticks.is_shown), name
        )

    def on_item(self, view: int, name: str) -> None:
        pressed = name.removeprefix(PRESS) if name.startswith(PRESS) else ""
        control = ControlName._value2member_map_.get(pressed)
        source = self._views.hand_source(SourceKind.MOUSE, view)
        if not self.controls.allows(source, None if control is None else ControlName(pressed)):
            return
        if not pressed:
            self._session.pages.choose(name)
        elif not self._session.operator.screen_sticks.pressed(pressed) and control is not None:
            self._flow.pressed(ControlName(pressed))
        self._is_changed = True

    def on_text(self, view: int, name: str, value: str) -> None:
        if self.controls.allows(self._views.hand_source(SourceKind.KEYBOARD, view)):
            self._session.pages.write(name, value)
            self._is_changed = True

    def on_frames(self, view: int, shown: int, dropped: int, refresh_hz: float) -> None:
        joined = self._views.joined.get(view)
        if joined is None:
            return
        joined.is_silent = False
        if view != self._views.watched(self.controls.holder):
            return
        hello = joined.hello
        report = DisplayReport(hello.kind, hello.device, refresh_hz, shown, dropped)
        self._control_loop.note_display(report)

    def on_picture(self, view: int, task: str, share: float) -> None:
        if view in self._views.joined:
            drawn = self._views.joined[view]
            drawn.task, drawn.share, drawn.waited_s = task, share, 0.0

    def on_visibility(self, view: int, is_visible: bool) -> None:
        if not is_visible:
            self._lose_sight(view, "unseen.hidden")

    def on_silence(self, view: int) -> None:
        self._lose_sight(view, "unseen.still")
        if view in self._views.joined:
            self._views.joined[view].is_silent = True

    def pressed(self, control: ControlName) -> None:
        self._flow.pressed(control)
        self._settle(is_changed=True)

    def input_pressed(self, device: InputDevice, name: str) -> bool:
        page = self._session.pages.top
        self._is_changed = True
        return page is not None and page.input_pressed(device, name)

    def taken_over(self, source: Source) -> None:
        say = self._session.say
        name = say(f"source.{source.kind.value}")
        self._session.notices.add(say("control.taken", source=name))
        self._flow.taken_over()
        self._is_changed = True

    def refused(self, _source: Source) -> None:
        holder, say = self.controls.holder, self._session.say
        if holder is not None:
            name, menu = say(f"source.{holder.kind.value}"), say("control.menu")
            key = "control.locked" if self._session.lock.is_locked else "control.held"
            text = say(key, source=name, menu=menu, seconds=IDLE_S)
            self._session.notices.add(text, Tone.WARNING)
            self._is_changed = True

    def unplugged(self, source: Source) -> None:
        if source == self.controls.holder:
            self._flow.pause("unseen.unplugged")
        self.controls.forget(source)

    def warn(self, about: str, key: str = "", **values: object) -> None:
        self._session.notices.warn(about, key, **values)
        self._is_changed = True

    def _feel(self, what: FeedbackEvent) -> None:
        preferences = self._session.preferences
        self.happened(what, 0.0 if preferences.muted else preferences.volume / 100.0)
        if what.rumble > 0.0:
            self.rumble(what.rumble, what.seconds)

    def _lose_sight(self, view: int, why: str) -> None:
        """Pause and release control if no one can see the trial; `why` is the key of a sentence."""
        if view == self._views.watched(self.controls.holder):
            self._flow.pause(why)
        for kind in SourceKind:
            self.controls.forget(self._views.source(kind, view))

    def _await_picture(self, dt: float) -> None:
        session, watched = self._session, self._views.watched(self.controls.holder)
        view = None if watched is None else self._views.joined.get(watched)
        # The views show the newest state only when it has been processed.
        is_replayed = self._flow.playback is not None
        training = (self.shown.latest if is_replayed else self._flow.shown(self._newest)).training
        task = training.task if training.is_marked else ""
        is_blind = session.goes_on_blind == session.training.trial_id != ""
        if view is not None or not self._views.joined:
            share = None if view is None else view.awaited_share(dt, task)
            session.picture_share = None if is_blind else share
        # A trial whose picture is not there is paused, so that its clock waits for it.
        is_missing = session.picture_share is not None and session.training.is_running
        self._without_picture_s = self._without_picture_s + dt if is_missing else 0.0
        waited = self._flow.waits_for_picture
        self._flow.waits_for_picture = self._without_picture_s > PICTURE_GRACE_S
        if self._flow.waits_for_picture and not waited:
            session.do(CommandName.PAUSE)

    def _follows(self) -> bool:
        """Return whether the view goes automatically to the best view of each next point."""
        session, tutorial = self._session, self._session.tutorial
        practiced = session.training if tutorial is None else tutorial
        has_learned = tutorial is None or tutorial.has_learned_view
        is_led = practiced.trainee in session.services.assigned.steps
        choice = session.preferences.view
        is_chosen = choice == "always" or (choice == "practice" and not is_led)
        # In a headset the trainee looks around by turning the head.
        return is_chosen and has_learned and practiced.mode != Mode.HMD.value

    def _advance_view(self, dt: float) -> None:
        """Move the view by `dt` seconds, and have the trial's journal say where it is."""
        session, view, follows = self._session, self._session.view, self._follows()
        view.advance(
            dt,
            self.shown.latest,
            self.shown.setup.scenario,
            self.controls.view,
            self.controls.sticks,
            follows and self.controls.situation is ControlContext.WORK,
        )
        self._since_noted_s += dt
        if not session.has_open_trial or self._since_noted_s < NOTED_S:
            return
        orbit = view.control.orbit
        report = ViewReport(
            round(orbit.azimuth_deg, 2),
            round(orbit.elevation_deg, 2),
            round(orbit.zoom, 2),
            view.control.is_automatic,
            follows,
        )
        if self._noted_view != (session.training.trial_id, report):
            self._noted_view = session.training.trial_id, report
            self._since_noted_s = 0.0
            self._control_loop.note_display(report)

    def _choose_mode(self, changed: Hello) -> None:
        if changed.kind == "headset":
            kinds = {view.hello.kind for view in self._views.joined.values()}
            self._session.mode = (Mode.HMD if "headset" in kinds else Mode.DESKTOP).value

    def _settle(self, is_changed: bool = False) -> None:
        self._is_changed = self._is_changed or is_changed
        self.shown.show(self._flow.playback)
        is_altered = self._session.tutorial is not None or self._session.drill is not None
        self.shown.alter = self._flow.shown if is_altered else None
        is_at_work = self._session.pages.top is None
        self.controls.enter(ControlContext.WORK if is_at_work else ControlContext.MENU)
        holder, setup = self.controls.holder, self._control_loop.setup
        camera = setup.scenario.cameras[self._control_loop.latest.camera]
        yaw_deg, axes = self._views.yaw_deg(holder), setup.settings.axes
        sticks = self._session.view.turned(self.controls.sticks, camera, axes, yaw_deg)
        if sticks != self._sent_sticks:
            self._sent_sticks = sticks
            self._control_loop.hold_sticks(sticks)
        control = Control() if holder is None else Control(holder.kind.value, holder.view)
        if control != self.control:
            self.control = control
            self.updates.publish(control)
            self._is_changed = True
