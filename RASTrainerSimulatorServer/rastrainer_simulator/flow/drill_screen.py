"""A case of the drill of decisions while its pages are closed: the head, and checked places."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rastrainer.protocol import Phase, RegistrationMethod
from rastrainer_simulator.flow.arm_screen import ArmScreen
from rastrainer_simulator.flow.pages.case import TIP, case_page, check_tip, drill_of, place_name
from rastrainer_simulator.input.inputs import ControlName, SourceKind
from rastrainer_simulator.presentation.screen import ErrorArrow, Screen, ScreenMessage, Tone
from rastrainer_simulator.state import SimulationState, TouchStage, TrainingState
from rastrainer_simulator.vectors import (
    Vector,
    add,
    distance,
    in_meters,
    scale,
    subtract,
    unit,
)
from rastrainer_simulator.viewpoint.view_control import orbit_beside

if TYPE_CHECKING:
    from rastrainer_simulator.decision.cases import DecisionCase

ABOVE_M = 0.06
"""The tool comes to a checked place from so far outside."""
EYE_M = 0.35
"""Distance of the viewpoint from the tip."""
BLOCKED_MM = 1.0
"""A tip that is stopped nearer to its goal has reached it."""
LEFT_M = 0.001
"""A tip that is farther from where it was stopped has been steered away."""

_IN_DRILL = TrainingState(phase=Phase.RUNNING, method=RegistrationMethod.LANDMARKS)
"""As in a trial, an arm that hides the tip is translucent."""


def shown_in_drill(state: SimulationState) -> SimulationState:
    """Return a state as views show it in a drill: without points to touch, and without alarms."""
    return replace(state, training=_IN_DRILL, touch=TouchStage.FAR)


@dataclass(eq=False)
class DrillScreen(ArmScreen):
    """The present case of the session's drill: the arm goes to each place that is checked.

    `_seen` are the case and the number of its checks for which the arm has gone.
    """

    _seen: tuple[DecisionCase, int] | None = None
    _place: str = ""
    _stopped_at: Vector | None = None

    @property
    def _state(self) -> SimulationState:
        return shown_in_drill(self._session.state)

    def screen(self) -> Screen:
        """Show the fiducials where they truly are: the head says no more than a real one."""
        session, drill = self._session, drill_of(self._session)
        case = session.placed_case
        is_marked = case.method is RegistrationMethod.FIDUCIALS
        # Rounded: more digits would tell how the fiducials were chosen.
        true_mm = case.truly(case.fixed_mm).round(1).tolist() if is_marked else ()
        balls = [
            ErrorArrow(place, place, Tone.PLAIN, name)
            for name, place in zip(case.labels, map(in_meters, true_mm), strict=False)
        ]
        names = {
            ControlName.TOUCH: "hint.check tip",
            ControlName.FINE: "hint.fine",
            ControlName.BEST_VIEW: "hint.close view",
            ControlName.CAMERA: "hint.front",
            ControlName.MENU: "hint.case",
        }
        movement = self._movement_hints()
        if session.operator.is_one_of(SourceKind.XR):
            # In a headset the head turns the view, and the sticks are drawn in the hands.
            del names[ControlName.BEST_VIEW]
            movement = ()
        title = session.say("case.title", number=drill.number, count=drill.count)
        clock = session.drill_clock
        status = [title] if clock is None else [title, clock.text]
        hints = self._hints(movement, names)
        return self._shown(self._instruction(), status, hints, errors=tuple(balls))

    def advance(self) -> None:
        """Send the arm to a place that has been checked, and the view there when it has arrived."""
        session, drill = self._session, drill_of(self._session)
        seen = drill.case, len(drill.checks)
        if self._seen != seen:
            self._seen, self._move, self._stopped_at = seen, None, None
            self._place = drill.checks[-1] if drill.checks else ""
            if self._place not in ("", TIP):
                self._begin_move(*self._goal(self._place))
                # The sticks still choose in the page that closes now.
                return
        was_moving = self._is_moving
        self._advance_move()
        if was_moving and not self._is_moving:
            self._stopped_at = session.state.tip
            self._look_at_tip()

    def pressed(self, control: ControlName) -> None:
        if control is ControlName.CAMERA:
            self._change_camera()
        elif control is ControlName.BEST_VIEW:
            self._look_at_tip()
        elif control is ControlName.TOUCH and not self._is_moving:
            check_tip(self._session)
        elif control in (ControlName.MENU, ControlName.PAUSE):
            self.open_menu()

    def open_menu(self) -> None:
        self._session.pages.show(case_page(self._session))

    def _goal(self, place: str) -> tuple[Vector, Vector]:
        """Return where the registration puts a place, and a place outside of it; World, m."""
        case = self._session.placed_case
        goal = in_meters(case.tip_for(case.places[place]))
        outward = unit(subtract(goal, in_meters(case.tip_for(case.target_mm))))
        return goal, add(goal, scale(outward, ABOVE_M))

    def _look_at_tip(self) -> None:
        session, tip = self._session, self._session.state.tip
        case, camera = session.placed_case, session.scenario.cameras[session.state.camera]
        outward = subtract(tip, in_meters(case.truly(case.target_mm)))
        session.view.control.go(orbit_beside(camera, tip, outward, EYE_M))

    def _instruction(self) -> ScreenMessage:
        session, move = self._session, self._move
        place = place_name(session, self._place)
        if self._is_moving:
            return self._message("case.moving", place=place)
        at = self._stopped_at
        if move is None or at is None or distance(at, session.state.tip) > LEFT_M:
            menu = session.operator.label(ControlName.MENU)
            return self._message("case.looking", menu=menu)
        if move.blocked_mm < BLOCKED_MM:
            said = self._message("case.arrived", place=place)
        else:
            off = f"{move.blocked_mm:.0f}"
            said = self._message("case.blocked", Tone.WARNING, place=place, distance=off)
        if not session.preferences.speech:
            return said
        # A listener hears what others see: the true position of the place.
        case = session.placed_case
        true = in_meters(case.truly(case.places[self._place]))
        return replace(said, text=f"{said.text} {self._toward(place, true)}")
