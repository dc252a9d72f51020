"""Texts for a trainee who drives the arm, and the distance of the tip from its path."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.journal.entries import FeedChange, PhaseChange, Reach, Rejected
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.arm import start_tip
from rastrainer_simulator.flow.session.arm_move import ArmMove
from rastrainer_simulator.flow.session.operator_device import SHOW, TILT
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.input.inputs import ControlName, SourceKind
from rastrainer_simulator.presentation.screen import PRESS, Hint, Screen, ScreenMessage, Tone
from rastrainer_simulator.state import Event, SimulationState, TouchStage
from rastrainer_simulator.teleoperation.steering import ROBOT_AXES, Axes, AxesChoice, camera_axes
from rastrainer_simulator.vectors import (
    ZERO,
    Vector,
    angle,
    cross,
    distance,
    dot,
    length,
    subtract,
    unit,
)
from rastrainer_simulator.viewpoint.view_control import FRONT

STEP_MM = 5.0
"""The distance to the target is shown in these steps: a constantly changing one is unreadable."""
LOOKED_AT_MM = 20.0
"""Nearer than this, a point is found by looking at it."""
PRACTICED_MM, PRACTICED_STEP_MM = 2.0, 1.0
"""In tutorial and trial run the way is said up to here, and below `LOOKED_AT_MM` in these steps."""
DEPTH_STEP_MM = 0.5
"""The same for the depth: a screen reader speaks each change of a warning."""
_LEVEL = (
    ControlName.MOVE_FORWARD,
    ControlName.MOVE_LEFT,
    ControlName.MOVE_BACK,
    ControlName.MOVE_RIGHT,
)


@dataclass
class ArmEvents:
    """The latest news of the arm, by the events of the simulation.

    Attributes:
        refusal: instruction that says why the last touch was refused.
        refused_at: where the tip was then, World, m.
        layer: that drill or instrument are in, since the phase began.
    """

    obstacle: str = ""
    is_within_reach: bool = True
    refusal: str = ""
    refused_at: Vector = ZERO
    layer: str = ""

    def note_event(self, event: Event, tip: Vector) -> None:
        match event.entry:
            case Rejected(message=message):
                self.refusal, self.refused_at = message, tip
            case Reach():
                self.is_within_reach = event.entry.is_within_reach
                self.obstacle = event.entry.obstacle
            case FeedChange(layer=layer):
                self.layer = layer
            case PhaseChange():
                self.layer = ""


@dataclass(eq=False)
class ArmScreen:
    """The warnings about the arm, the directions to a point, and the hints on movement."""

    _session: TrainingSession
    _arm: ArmEvents
    _move: ArmMove | None = field(default=None, init=False)

    @property
    def _start(self) -> Vector:
        """Where the tip is at the start of a trial: above the head; World, m."""
        session = self._session
        return start_tip(session.scenario, session.control_loop.setup.settings.start_height)

    @property
    def _is_moving(self) -> bool:
        return self._move is not None and not self._move.is_over

    def _begin_move(self, goal: Vector, above: Vector) -> None:
        """Have the arm move over the head to a place above a goal, and down to it; World, m."""
        tip, session = self._session.state.tip, self._session
        high = max(tip[2], above[2], self._start[2])
        way = [(*tip[:2], high), (*above[:2], high), above, goal]
        self._move = ArmMove(session.move_tip, way)

    def _advance_move(self) -> None:
        if self._move is not None and self._is_moving:
            session = self._session
            self._move.advance(session.simulated_s, session.state.tip, session.controls.held)

    @property
    def _state(self) -> SimulationState:
        return self._session.state

    @property
    def _is_refused(self) -> bool:
        refusal = self._arm.refusal
        return refusal != "" and self._state.training.instruction == refusal

    def _shown(
        self,
        instruction: ScreenMessage,
        status: Sequence[str],
        hints: tuple[Hint, ...],
        **others: Any,
    ) -> Screen:
        return Screen(
            instruction=instruction,
            warnings=self.warnings(),
            status=tuple(status),
            hints=hints,
            has_sticks=self._session.operator.screen_sticks.is_shown,
            **others,
        )

    def _message(self, key: str, tone: Tone = Tone.PLAIN, **values: object) -> ScreenMessage:
        return ScreenMessage(self._session.say(key, **values), tone)

    def _instructed(self, tone: Tone) -> ScreenMessage:
        return ScreenMessage(self._session.texts.again(self._state.training.instruction), tone)

    def warnings(self) -> tuple[ScreenMessage, ...]:
        warnings = []
        state = self._state
        if state.touch in (TouchStage.PRESSED, TouchStage.TOO_DEEP):
            depth_mm = DEPTH_STEP_MM * round(MM_PER_M * state.depth / DEPTH_STEP_MM)
            tone = Tone.ERROR if state.touch is TouchStage.TOO_DEEP else Tone.WARNING
            warnings.append(self._message("warning.pressing", tone, depth=depth_mm))
        elif state.touch in (TouchStage.SHAFT, TouchStage.ELSEWHERE):
            warnings.append(self._message(f"warning.{state.touch.value}", Tone.ERROR))
        if self._arm.obstacle:
            warnings.append(self._message(f"warning.obstacle.{self._arm.obstacle}", Tone.ERROR))
        elif not self._arm.is_within_reach:
            warnings.append(self._message("warning.reach", Tone.WARNING))
        return tuple(warnings)

    def _change_camera(self) -> None:
        """Look from the front again; from there already, change between near and far."""
        session = self._session
        if session.view.control.is_moved:
            session.view.control.go(FRONT)
        else:
            camera = "far" if session.state.camera == "close-up" else "close-up"
            session.do(CommandName.SET_CAMERA, {"camera": camera})

    def _movement_hints(self) -> tuple[Hint, ...]:
        session = self._session
        return (
            Hint(session.operator.stick_label(_LEVEL), session.say("hint.move")),
            session.operator.hint("hint.up_and_down", ControlName.MOVE_UP, ControlName.MOVE_DOWN),
        )

    def _hints(
        self, moving: Iterable[Hint], names: Mapping[ControlName, str], can_tilt: bool = False
    ) -> tuple[Hint, ...]:
        session, operator = self._session, self._session.operator
        say, sticks = session.say, session.operator.screen_sticks
        hints = list(moving)
        for control, key in names.items():
            item = None
            if control is ControlName.FINE and operator.steers_by_mouse:
                # A mouse switches on and off the control that other devices hold.
                key = "hint.on" if sticks.is_slow else "hint.off"
            elif control is ControlName.FINE:
                key, item = "hint.fine", ""
            hints.append(operator.hint(key, control, item=item))
        if operator.is_one_of(SourceKind.MOUSE):
            action = say("hint.hide sticks" if sticks.is_shown else "hint.sticks")
            hints.append(Hint(say("hint.mouse"), action, PRESS + SHOW))
            if can_tilt and sticks.is_shown:
                key = "hint.tilt" if sticks.is_tilting else "hint.up_and_down"
                hints.append(Hint(say("hint.right stick"), say(key), PRESS + TILT))
        return tuple(hints)

    def _toward(self, name: str, target: Vector, nearest_mm: float = PRACTICED_MM) -> str:
        """Return how far and in which directions a point is (World, m), in words, after its name.

        Nearer than `nearest_mm` nothing but that is said: words that lead onto the point would
        replace looking.
        """
        session = self._session
        away = MM_PER_M * distance(session.state.tip, target)
        if away < nearest_mm:
            return session.say("status.near", name=name, distance=f"{nearest_mm:.0f}")
        step_mm = STEP_MM if away >= LOOKED_AT_MM else PRACTICED_STEP_MM
        words = direction_words(session.state.tip, target, self._axes())
        return session.say(
            "status.toward",
            name=name,
            distance=f"{step_mm * round(away / step_mm):.0f}",
            direction=session.texts.listed(session.say(f"way.{word}") for word in words),
        )

    def _on_skin(self) -> ScreenMessage:
        touch = self._session.operator.label(ControlName.TOUCH)
        return self._message("work.on skin", Tone.GOOD, touch=touch)

    def _touched(self, key: str, tone: Tone, label: str, error_mm: float) -> ScreenMessage:
        undo, point = (
            self._session.operator.label(ControlName.UNDO),
            self._state.training.next_point,
        )
        return self._message(key, tone, label=label, error=error_mm, point=point, undo=undo)

    def _axes(self) -> Axes:
        session = self._session
        if session.preferences.axes == AxesChoice.ROBOT:
            return ROBOT_AXES
        view = session.scenario.cameras[session.state.camera]
        line = tuple((view.focal_point_mm - view.position_mm).tolist())
        axes = camera_axes(line, tuple(view.view_up.tolist()))
        return axes.turned(math.radians(session.view.stick_turn_deg))


FARTHEST = 0.045
"""Largest distance from the path at which the tip is on it, m."""
BACK_WITHIN = 0.03
"""Distance from the path at which the tip is on it again, m."""
ABOVE_LEAST = 0.35
"""Share of the largest component from which another one is worth a word."""

_WORDS = (("left", "right"), ("back", "forward"), ("down", "up"))


def off_path(tip: Vector, center: Vector, start: Vector, end: Vector) -> float:
    """Return the distance of the tip from the path over the head, along the head, in m.

    The tool is lifted, carried around the head and lowered: the path is the shorter arc about the
    head's center from one point to the next, at any height. World, m.
    """
    first, last, here = (unit(subtract(place, center)) for place in (start, end, tip))
    pole = unit(cross(first, last))
    off_rad = min(angle(here, first), angle(here, last))
    is_between = dot(cross(pole, first), here) >= 0.0 and dot(cross(last, pole), here) >= 0.0
    if length(pole) > 0.0 and is_between:
        off_rad = abs(math.asin(max(-1.0, min(1.0, dot(here, pole)))))
    return length(subtract(tip, center)) * off_rad


def direction_words(tip: Vector, target: Vector, axes: Axes) -> tuple[str, ...]:
    """Return the directions in which the tip has to go, as the operator sees it, longest first.

    Each is "left", "right", "back", "forward", "down" or "up"; a short part has no word.
    """
    away = subtract(target, tip)
    parts = [
        (dot(away, axis), words)
        for axis, words in zip((axes.right, axes.forward, axes.up), _WORDS, strict=True)
    ]
    largest = max(abs(part) for part, _ in parts)
    named = [each for each in parts if abs(each[0]) > ABOVE_LEAST * largest]
    named.sort(key=lambda each: -abs(each[0]))
    return tuple(words[part > 0.0] for part, words in named)
