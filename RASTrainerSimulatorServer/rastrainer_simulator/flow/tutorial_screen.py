"""Texts and controls of the tutorial, and the way of the arm to its start."""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer.commands import CommandName
from rastrainer.journal.entries import GUIDED_TOUCHES
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.flow.arm_screen import ArmScreen
from rastrainer_simulator.flow.pages.introduction import tutorial_page
from rastrainer_simulator.flow.pages.trial_review import POOR_MM, error_arrow, error_tone
from rastrainer_simulator.flow.session.tutorial import (
    CENTERED_M,
    DONE_DEG,
    DONE_MM,
    Tutorial,
    TutorialObservation,
    TutorialStep,
)
from rastrainer_simulator.input.inputs import ControlName
from rastrainer_simulator.presentation.feedback_event import FeedbackEvent
from rastrainer_simulator.presentation.screen import ErrorArrow, Hint, Screen, ScreenMessage, Tone
from rastrainer_simulator.state import SimulationState, TouchStage
from rastrainer_simulator.training.training import TrainingReply
from rastrainer_simulator.vectors import distance

LIMIT_MM = f"{MM_PER_M * CENTERED_M:g}"
STEP_MM, STEP_DEG = 5, 5
"""Progress is shown in these steps: a constantly changing figure is unreadable."""
NEAR_M = 0.02
"""Within this distance of the start the arm stays where it is."""


@dataclass(eq=False)
class TutorialScreen(ArmScreen):
    """The present step of the session's tutorial, its progress and its controls."""

    _seen: Tutorial | None = None
    _has_paused: bool = False

    @property
    def _tutorial(self) -> Tutorial:
        tutorial = self._session.tutorial
        assert tutorial is not None, "The screen is shown while there is a tutorial."
        return tutorial

    @property
    def _state(self) -> SimulationState:
        return self._tutorial.practice.shown(self._session.state)

    def screen(self) -> Screen:
        """Show the errors of guided touches, as a result does."""
        practice = self._tutorial.practice
        errors: tuple[ErrorArrow, ...] = ()
        if self._tutorial.step in (TutorialStep.GUIDED, None):
            points, touches = self._tutorial.points, practice.training.state.touches
            errors = tuple(error_arrow(points[t.label], t.position) for t in touches)
        return self._shown(
            self._instruction(),
            self._status(),
            self._all_hints(),
            has_arrow=practice.has_points,
            errors=errors,
        )

    def advance(self, dt: float) -> None:
        session, tutorial = self._session, self._tutorial
        if tutorial is not self._seen:
            self._seen, self._has_paused = tutorial, False
            self._move = None
            if distance(session.state.tip, self._start) > NEAR_M:
                self._begin_move(self._start, self._start)
        self._advance_move()
        if self._is_moving:
            return
        tutorial.use(session.operator.learned(session.mode))
        tutorial.practice.training.end_refusal(session.state.sim_time)
        practice = tutorial.practice.training.state
        seen = TutorialObservation(
            tip=session.state.tip,
            axes=self._axes(),
            is_slow=session.controls.held.fine,
            orbit=session.view.control.orbit,
            yaw_deg=session.view.yaw_deg,
            has_best_view=session.view.has_moved_to(practice.next_point),
            touch=self._state.touch,
            touched=len(practice.touches),
            undone=practice.undone,
            has_paused=self._has_paused,
        )
        done = tutorial.advance(dt, seen)
        if done is not None:
            self._has_paused = False
            is_heard_anyway = {ControlName.TOUCH, ControlName.UNDO} & {*done.controls}
            if not is_heard_anyway:
                session.happened(FeedbackEvent.STEP)

    def pressed(self, control: ControlName) -> None:
        session, tutorial = self._session, self._tutorial
        if control is ControlName.CAMERA:
            self._change_camera()
        elif control is ControlName.BEST_VIEW and tutorial.practice.has_points:
            session.view.is_best_wanted = True
        elif control is ControlName.TOUCH and tutorial.may_touch:
            self._play_reply(tutorial.touch(session.state))
        elif control is ControlName.UNDO and tutorial.asks_for(ControlName.UNDO):
            self._play_reply(tutorial.practice.handle(CommandName.UNDO, session.state))
        elif control in (ControlName.MENU, ControlName.PAUSE):
            self.open_menu()

    def open_menu(self) -> None:
        self._has_paused = self._tutorial.step is TutorialStep.PAUSE
        self._session.pages.show(tutorial_page(self._session))

    def _instruction(self) -> ScreenMessage:
        tutorial = self._tutorial
        practice, errors = tutorial.practice.training.state, tutorial.practice.errors_mm()
        if self._is_moving:
            return self._message("tutorial.homing")
        if self._is_refused:
            return self._instructed(Tone.WARNING)
        if tutorial.praised is not None:
            if ControlName.TOUCH in tutorial.praised.controls and errors:
                error = errors[-1]
                return self._message("tutorial.recorded", _banner(error), error=error)
            return self._message("tutorial.praise", Tone.GOOD)
        if tutorial.may_touch and self._state.touch is TouchStage.ON_SKIN:
            return self._on_skin()
        off_mm = tutorial.practice.off_center_mm(self._session.state)
        if tutorial.may_touch and off_mm is not None:
            off, point = f"{off_mm:.0f}", practice.next_point
            return self._message("tutorial.center", Tone.WARNING, point=point, distance=off)
        if tutorial.step is TutorialStep.GUIDED and errors:
            key = "tutorial.slipped" if errors[-1] >= POOR_MM else "tutorial.touched"
            label = practice.touches[-1].label
            return self._touched(key, _banner(errors[-1]), label, errors[-1])
        is_on_point = self._state.touch in (TouchStage.ON_SKIN, TouchStage.PRESSED)
        is_lifted = tutorial.step is TutorialStep.TOUCH and not is_on_point
        return ScreenMessage(self._sentence(TutorialStep.LOWER if is_lifted else tutorial.step))

    def _status(self) -> list[str]:
        tutorial, say = self._tutorial, self._session.say
        step, steps = tutorial.place
        place = () if tutorial.practiced else (say("tutorial.place", step=step, steps=steps),)
        facts: list[str] = [self._session.practice_title, *place]
        key = tutorial.step.shown if tutorial.step is not None else ""
        if key and tutorial.praised is None:
            done, goal = tutorial.amount
            coarse = {DONE_MM: STEP_MM, DONE_DEG: STEP_DEG}.get(key, 1)
            facts.append(say(key, done=coarse * int(done / coarse), goal=int(goal)))
        label = tutorial.practice.training.state.next_point
        if tutorial.may_touch and label is not None:
            facts.append(self._toward(say("status.point", point=label), tutorial.points[label]))
        return facts

    def _all_hints(self) -> tuple[Hint, ...]:
        session, step = self._session, self._tutorial.step
        operator = session.operator
        if step is None:
            return ()
        controls = step.controls
        moving: list[Hint] = []
        names: dict[ControlName, str] = {}
        if step is TutorialStep.TURN_VIEW:
            moving.append(operator.hint("hint.turn_view", *controls))
        elif step.way is not None or step is TutorialStep.LOOK_AROUND:
            (control,) = controls
            moving.append(operator.hint(f"control.{control.value}", control, item=""))
        else:
            has_view = TutorialStep.BEST_VIEW in self._tutorial.steps
            there = [each for each in controls if has_view or each is not ControlName.BEST_VIEW]
            names = {each: f"control.{each.value}" for each in there}
        if ControlName.FINE in controls:
            # The tip may go anywhere: all that moves it is among the hints.
            moving += self._movement_hints()
        if step is not TutorialStep.PAUSE:
            names[ControlName.MENU] = "hint.menu"
        return self._hints(moving, names)

    def _play_reply(self, reply: TrainingReply) -> None:
        for event in reply.events:
            self._arm.note_event(event, self._session.state.tip)
        self._session.feel(reply.events, self._state.touch)

    def _sentence(self, step: TutorialStep | None) -> str:
        if step is None:
            return ""
        session = self._session
        controls = step.controls
        is_pair = step is TutorialStep.TURN_VIEW
        name = session.operator.label(*(controls if is_pair else controls[:1]))
        key = f"tutorial.{step.value}"
        for variant in (session.operator.learned(session.mode).value, session.preferences.axes):
            if f"{key}.{variant}" in session.texts:
                key = f"{key}.{variant}"
        point = self._tutorial.practice.training.state.next_point
        return session.say(key, control=name, point=point, count=GUIDED_TOUCHES, limit=LIMIT_MM)


def _banner(error_mm: float) -> Tone:
    """Return the tone of a sentence about a touch: a mediocre one is no alarm."""
    return Tone.GOOD if error_tone(error_mm) is Tone.GOOD else Tone.WARNING
