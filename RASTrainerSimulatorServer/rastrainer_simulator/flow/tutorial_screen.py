"""Texts and controls of the tutorial, and the way of the arm to its start."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rastrainer.commands import CommandName
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.arm import start_tip
from rastrainer_simulator.flow.arm_screen import ArmScreen
from rastrainer_simulator.flow.pages.introduction import tutorial_page
from rastrainer_simulator.flow.pages.session_page import clickable_hint, stick_hints
from rastrainer_simulator.flow.pages.trial_review import POOR_MM, error_arrow, error_tone
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.flow.tutorial.steps import TutorialObservation, TutorialStep
from rastrainer_simulator.flow.tutorial.tutorial import CENTERED_M, Tutorial
from rastrainer_simulator.input.inputs import ControlName
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent, feedback_event
from rastrainer_simulator.presentation.screen import ErrorArrow, Hint, Screen, ScreenMessage, Tone
from rastrainer_simulator.record.trial_context import GUIDED_TOUCHES
from rastrainer_simulator.state import SimulationState, TouchStage
from rastrainer_simulator.training.training import TrainingReply
from rastrainer_simulator.vectors import Vector, distance, in_meters

LIMIT_MM = f"{MM_PER_M * CENTERED_M:g}"
STEP_MM, STEP_DEG = 5, 5
"""Progress is shown in these steps: a constantly changing figure is unreadable."""
_CONTROLS: Mapping[TutorialStep, tuple[ControlName, ...]] = {
    TutorialStep.RIGHT: (ControlName.MOVE_RIGHT,),
    TutorialStep.LEFT: (ControlName.MOVE_LEFT,),
    TutorialStep.FORWARD: (ControlName.MOVE_FORWARD,),
    TutorialStep.BACK: (ControlName.MOVE_BACK,),
    TutorialStep.UP: (ControlName.MOVE_UP,),
    TutorialStep.DOWN: (ControlName.MOVE_DOWN,),
    TutorialStep.SLOW: (ControlName.FINE,),
    TutorialStep.TURN_VIEW: (ControlName.VIEW_LEFT, ControlName.VIEW_RIGHT),
    TutorialStep.LOOK_AROUND: (ControlName.MOVE_FORWARD,),
    TutorialStep.BEST_VIEW: (ControlName.BEST_VIEW,),
    TutorialStep.LOWER: (ControlName.FINE, ControlName.BEST_VIEW),
    TutorialStep.TOUCH: (ControlName.TOUCH, ControlName.FINE, ControlName.BEST_VIEW),
    TutorialStep.UNDO: (ControlName.UNDO,),
    TutorialStep.PAUSE: (ControlName.MENU,),
    TutorialStep.GUIDED: (
        ControlName.TOUCH,
        ControlName.UNDO,
        ControlName.FINE,
        ControlName.BEST_VIEW,
    ),
    TutorialStep.AGAIN: (ControlName.TOUCH, ControlName.FINE, ControlName.BEST_VIEW),
}
"""The controls of each step; its sentence names the first, or the first two as a pair."""
_FREE = (
    TutorialStep.SLOW,
    TutorialStep.LOWER,
    TutorialStep.TOUCH,
    TutorialStep.GUIDED,
    TutorialStep.AGAIN,
)
"""Steps in which the tip may go anywhere: all that moves it is among the hints."""
MOVES = tuple(TutorialStep)[:6]
"""Steps that move the tip in one direction."""
_MM, _DEG = "tutorial.done mm", "tutorial.done degrees"
_AMOUNTS: Mapping[TutorialStep, str] = {
    **dict.fromkeys((*MOVES, TutorialStep.SLOW), _MM),
    TutorialStep.TURN_VIEW: _DEG,
    TutorialStep.LOOK_AROUND: _DEG,
    TutorialStep.GUIDED: "tutorial.done points",
}
"""Key of the text that says how much of a step is done."""
_TOUCHED = (TutorialStep.TOUCH, TutorialStep.GUIDED, TutorialStep.AGAIN)
_HEARD_ANYWAY = (*_TOUCHED, TutorialStep.UNDO)
NEAR_M = 0.02
"""Within this distance the arm counts as arrived."""
SPEED_MM_S = 250.0
LONGEST_S = 6.0
TAKEN_OVER = 0.2
"""A stick that is pushed farther counts as intended."""


class TutorialScreen(ArmScreen):
    """The present step of the session's tutorial, its progress and its controls."""

    def __init__(self, session: TrainingSession) -> None:
        super().__init__(session)
        self._seen: Tutorial | None = None
        self._homing: Homing | None = None
        self._points: dict[str, Vector] = {}
        self._has_paused = False

    @property
    def _tutorial(self) -> Tutorial:
        tutorial = self._session.tutorial
        assert tutorial is not None, "The screen is shown while there is a tutorial."
        return tutorial

    @property
    def _state(self) -> SimulationState:
        return self._tutorial.practice.shown(self._session.state)

    @property
    def _is_homing(self) -> bool:
        return self._homing is not None and not self._homing.is_done

    def screen(self) -> Screen:
        """Show the errors of guided touches, as a result does."""
        practice = self._tutorial.practice
        errors: tuple[ErrorArrow, ...] = ()
        if self._tutorial.step in (TutorialStep.GUIDED, None):
            touches = practice.state.touches
            errors = tuple(error_arrow(self._points[t.label], t.position) for t in touches)
        return replace(super().screen(), has_arrow=practice.has_points, errors=errors)

    def advance(self, dt: float) -> None:
        """Advance by `dt` seconds: bring the arm to its start, then check the progress."""
        session, tutorial = self._session, self._tutorial
        if tutorial is not self._seen:
            self._begin(tutorial)
        if self._homing is not None and self._is_homing:
            self._homing.advance(dt)
            return
        tutorial.use(session.operator.learned(session.mode))
        tutorial.practice.end_refusal(session.state.sim_time)
        done = tutorial.advance(dt, self._observation())
        if done is not None:
            self._has_paused = False
            if done not in _HEARD_ANYWAY:
                session.happened(FeedbackEvent.STEP)

    def pressed(self, control: ControlName) -> None:
        """Carry out a control; those not learned yet do nothing."""
        session, tutorial = self._session, self._tutorial
        if control is ControlName.CAMERA:
            self._change_camera()
        elif control is ControlName.BEST_VIEW and tutorial.practice.has_points:
            session.view.want_best()
        elif control is ControlName.TOUCH and tutorial.may_touch:
            self._take(tutorial.touch(session.state))
        elif control is ControlName.UNDO and tutorial.may_undo:
            self._take(tutorial.practice.undo(session.state))
        elif control in (ControlName.MENU, ControlName.PAUSE):
            self.open_menu()

    def open_menu(self) -> None:
        self._has_paused = self._tutorial.step is TutorialStep.PAUSE
        self._session.pages.show(tutorial_page(self._session))

    def instruction(self) -> ScreenMessage:
        session, tutorial = self._session, self._tutorial
        say = session.texts.say
        if self._is_homing:
            return ScreenMessage(say("tutorial.homing"))
        if self._is_refused:
            sentence = session.texts.again(tutorial.practice.state.instruction)
            return ScreenMessage(sentence, Tone.WARNING)
        if tutorial.praised is not None:
            return self._praise(tutorial.praised)
        if tutorial.may_touch and self._state.touch is TouchStage.ON_SKIN:
            key = session.operator.label(ControlName.TOUCH)
            return ScreenMessage(say("work.on skin", touch=key), Tone.GOOD)
        off_mm = tutorial.practice.off_center_mm(session.state)
        if tutorial.may_touch and off_mm is not None:
            point = tutorial.practice.state.next_point
            text = say("tutorial.center", point=point, distance=f"{off_mm:.0f}")
            return ScreenMessage(text, Tone.WARNING)
        practice, errors = tutorial.practice.state, tutorial.practice.errors_mm()
        if tutorial.step is TutorialStep.GUIDED and errors:
            touched, point = practice.touches[-1].label, practice.next_point
            undo = session.operator.label(ControlName.UNDO)
            key = "tutorial.slipped" if errors[-1] >= POOR_MM else "tutorial.touched"
            text = say(key, label=touched, error=errors[-1], point=point, undo=undo)
            return ScreenMessage(text, _banner(errors[-1]))
        is_on_point = self._state.touch in (TouchStage.ON_SKIN, TouchStage.PRESSED)
        is_lifted = tutorial.step is TutorialStep.TOUCH and not is_on_point
        return ScreenMessage(self._sentence(TutorialStep.LOWER if is_lifted else tutorial.step))

    def status(self) -> tuple[str, ...]:
        tutorial, say = self._tutorial, self._session.texts.say
        step, steps = tutorial.place
        place = () if tutorial.practiced else (say("tutorial.place", step=step, steps=steps),)
        facts: list[str] = [self._session.practice_title, *place]
        key = _AMOUNTS.get(tutorial.step) if tutorial.step is not None else None
        if key is not None and tutorial.praised is None:
            done, goal = tutorial.amount
            coarse = {_MM: STEP_MM, _DEG: STEP_DEG}.get(key, 1)
            facts.append(say(key, done=coarse * int(done / coarse), goal=int(goal)))
        label = tutorial.practice.state.next_point
        if tutorial.may_touch and label is not None:
            facts.append(self._toward(say("status.point", point=label), self._points[label]))
        return tuple(facts)

    def hints(self) -> tuple[Hint, ...]:
        session, step = self._session, self._tutorial.step
        say = session.texts.say
        if step is None:
            return ()
        controls = _CONTROLS[step]
        if step is TutorialStep.TURN_VIEW:
            hints = [Hint(session.operator.pair_label(*controls), say("hint.turn_view"))]
        elif step in (*MOVES, TutorialStep.LOOK_AROUND):
            hints = [
                Hint(session.operator.label(name), say(f"control.{name.value}"))
                for name in controls
            ]
        else:
            named = {name: f"control.{name.value}" for name in controls if self._is_there(name)}
            hints = list(self._control_hints(named))
        moving = self._movement_hints() if step in _FREE else ()
        if step is not TutorialStep.PAUSE:
            hints.append(clickable_hint(session, ControlName.MENU, "hint.menu"))
        return (*moving, *hints, *stick_hints(session))

    def _begin(self, tutorial: Tutorial) -> None:
        self._seen, self._homing = tutorial, Homing(self._session)
        self._points = {label: in_meters(point) for label, point in tutorial.fiducials.items()}
        self._has_paused = False

    def _observation(self) -> TutorialObservation:
        session, state = self._session, self._state
        practice = self._tutorial.practice.state
        return TutorialObservation(
            tip=session.tip,
            axes=self._axes(),
            is_slow=session.controls.held.fine,
            orbit=session.view.control.orbit,
            yaw_deg=session.view.yaw_deg,
            has_best_view=session.view.has_moved_to(practice.next_point),
            touch=state.touch,
            touched=len(practice.touches),
            undone=practice.undone,
            has_paused=self._has_paused,
        )

    def _take(self, reply: TrainingReply) -> None:
        """Play the sound of a touch's outcome, and show why it was refused."""
        session = self._session
        for event in reply.events:
            self.take(event)
            felt = feedback_event(event, self._state.touch)
            if felt is not None:
                session.happened(felt)

    def _praise(self, step: TutorialStep) -> ScreenMessage:
        say = self._session.texts.say
        errors = self._tutorial.practice.errors_mm()
        if step in _TOUCHED and errors:
            return ScreenMessage(say("tutorial.recorded", error=errors[-1]), _banner(errors[-1]))
        return ScreenMessage(say("tutorial.praise"), Tone.GOOD)

    def _sentence(self, step: TutorialStep | None) -> str:
        """Return what to do in a step, as it is done with the device in use."""
        if step is None:
            return ""
        session = self._session
        controls = _CONTROLS[step]
        is_pair = step is TutorialStep.TURN_VIEW
        name = (
            session.operator.pair_label(*controls)
            if is_pair
            else session.operator.label(controls[0])
        )
        key = f"tutorial.{step.value}"
        for variant in (session.operator.learned(session.mode).value, session.preferences.axes):
            if f"{key}.{variant}" in session.texts:
                key = f"{key}.{variant}"
        point = self._tutorial.practice.state.next_point
        return session.texts.say(
            key, control=name, point=point, count=GUIDED_TOUCHES, limit=LIMIT_MM
        )

    def _is_there(self, control: ControlName) -> bool:
        """Return whether the device in use has a control."""
        has_view = TutorialStep.BEST_VIEW in self._tutorial.steps
        return control is not ControlName.BEST_VIEW or has_view


def _banner(error_mm: float) -> Tone:
    """Return the tone of a sentence about a touch: a mediocre one is no alarm."""
    return Tone.GOOD if error_tone(error_mm) is Tone.GOOD else Tone.WARNING


class Homing:
    """Moves the tip up, then across, and down to the start; using the sticks ends it."""

    def __init__(self, session: TrainingSession) -> None:
        self._session = session
        goal = start_tip(session.scenario, session.control_loop.setup.settings.start_height)
        tip = session.tip
        high = max(tip[2], goal[2])
        self._way: list[Vector] = [(*tip[:2], high), (*goal[:2], high), goal]
        self._is_commanded = False
        self._left_s = LONGEST_S
        if distance(tip, goal) < NEAR_M:
            self._way.clear()

    @property
    def is_done(self) -> bool:
        """Whether the arm has arrived, or was taken over."""
        return not self._way

    def advance(self, dt: float) -> None:
        """Command the next part of the path once the previous one is done."""
        session = self._session
        self._left_s -= dt
        is_taken_over = max(map(abs, session.controls.held.translation)) > TAKEN_OVER
        if self._left_s < 0.0 or is_taken_over:
            self._way.clear()
        while self._way and distance(session.tip, self._way[0]) < NEAR_M / 4.0:
            del self._way[0]
            self._is_commanded = False
        if self._way and not self._is_commanded:
            self._is_commanded = True
            place = [MM_PER_M * value for value in self._way[0]]
            session.do(CommandName.MOVE_TIP_TO, {"positionMm": place, "speedMmS": SPEED_MM_S})
