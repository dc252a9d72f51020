"""Which command is allowed in which phase, which touch counts, and the sentences of refusals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer.commands import AFTER_THE_TOUCHES, COMMANDS, CommandName
from rastrainer.json_checks import Setting
from rastrainer.motion.trajectory import RELEASED_MM
from rastrainer.protocol import (
    FIDUCIAL_COUNT,
    FINISHED_PHASES,
    MAX_TRACE_POINTS,
    MIN_TRACE_POINTS,
    Phase,
    Proximity,
    RegistrationMethod,
    TouchRule,
)
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.scoring import DEPTH_LIMIT_MM
from rastrainer_simulator.state import OperatorCommand, TouchStage, TrainingState
from rastrainer_simulator.texts.texts import say
from rastrainer_simulator.training.feed import NO_FEED, Feed
from rastrainer_simulator.vectors import ZERO, Vector, distance, in_millimeters

RECORDING_FAILED = "RecordingFailed"
"""Used by the control loop to undo what could not be written; clients cannot send it."""

INTERRUPTED = "Interrupted"
"""Pauses a trial that a server's end has cut short; clients cannot send it."""

TRACED = "Traced"
"""Adds the point where the tip is to the stroke that is being drawn; clients cannot send it."""

REFUSALS: Mapping[str, Mapping[Phase, str]] = {
    **{each: each.refused for each in COMMANDS.values() if each.refused is not None},
    TRACED: AFTER_THE_TOUCHES,
    RECORDING_FAILED: {},
    INTERRUPTED: dict.fromkeys((Phase.IDLE, *FINISHED_PHASES), "no trial"),
}
"""For each command of the simulation the phases in which it is wrong, and the sentence's key."""

ENDING_A_TRIAL = (CommandName.SUBMIT_REGISTRATION, CommandName.TRIAL_SCORED)
"""Commands by which a client ends a registered trial: its registration, then its score."""

NAMING_A_TRIAL = (*ENDING_A_TRIAL, CommandName.USE_REGISTRATION, CommandName.GET_TRIAL)


def refusal(
    command: OperatorCommand, state: TrainingState, count: int = FIDUCIAL_COUNT
) -> str | None:
    """Return the sentence that refuses a command in the trial's phase, None if it is allowed.

    A command that names a trial is right for the present trial only: an Abort may arrive late.
    `count` is how many points the trial has to touch.
    """
    if command.name not in REFUSALS:
        return say("not a simulation command", command=command.name)
    named = command.arguments.get("trialId")
    is_other = named not in (None, state.trial_id)
    if command.name in NAMING_A_TRIAL and is_other:
        return say("no such trial", trial_id=named)
    key = _trace_key(command.name, state, REFUSALS[command.name].get(state.phase))
    if key is None and command.name == CommandName.ABORT and is_other:
        key = "another trial is open"
    if key is None:
        return None
    return say(
        key,
        trainee=state.trainee,
        task=state.task,
        point=state.next_point,
        kept=len(state.touches),
        count=count,
        traced=0 if state.trace is None else len(state.trace.points),
        least=MIN_TRACE_POINTS,
        most=MAX_TRACE_POINTS,
    )


_OF_A_TRACE = {"all touched": "all traced", "not paused": "not paused trace"}


def _trace_key(command: str, state: TrainingState, key: str | None) -> str | None:
    """Return a refusal's key where the trial has a trace, or the command needs one; else `key`."""
    trace, is_running = state.trace, state.phase is Phase.RUNNING
    if command in (CommandName.TRACE, TRACED) and key is None:
        if trace is None:
            return "nothing is traced"
        if state.next_point is not None:
            return "landmarks first"
        return "trace is full" if trace.is_full else None
    if trace is None or state.next_point is not None:
        return key
    if command == CommandName.REGISTER and is_running:
        return "still tracing" if trace.is_on else "too few traced"
    if command == CommandName.CAPTURE and is_running:
        return "landmarks touched"
    return _OF_A_TRACE.get(key or "", key)


@dataclass(frozen=True)
class TrainingSettings:
    """The rules of a touch.

    Attributes:
        acceptance_radius: the longest distance of the tip to the fiducial, m.
        landmark_radius: the same of a landmark, which is not marked on the skin.
        touch_rule: whether the tip has to be on the skin.
        skin_tolerance: the longest distance of the tip to the skin at which it is on it, m.
    """

    acceptance_radius: Setting = 0.010
    touch_rule: TouchRule = TouchRule.ON_SKIN
    skin_tolerance: Setting = 0.0005
    landmark_radius: Setting = 0.020

    def radius(self, method: RegistrationMethod) -> float:
        is_marked = method is RegistrationMethod.FIDUCIALS
        return self.acceptance_radius if is_marked else self.landmark_radius

    def is_above(self, now: TouchMoment) -> bool:
        """Return whether the tip is above the skin, and the rule is that it has to be on it."""
        return self.touch_rule is TouchRule.ON_SKIN and now.tip_clearance > self.skin_tolerance


@dataclass(frozen=True)
class TouchMoment:
    """When and where a command is carried out.

    Attributes:
        tip_clearance: signed distance of the tip to the skin, m; below 0 within the head.
        depth: how far the tip is pressed in, m; see `SimulationState.depth`.
        direction: of the tool, a unit vector from A7 to the tip, World; ZERO where it has no part.
        feed: how far the instrument is beyond the guide's tip; for LockGuide, with the way ahead.
    """

    sim_time: float
    tip: Vector
    tip_clearance: float
    depth: float = 0.0
    direction: Vector = ZERO
    feed: Feed = NO_FEED

    @property
    def place(self) -> dict[str, Any]:
        """Where a touch is, in mm, as the journal has it."""
        return {
            "position_mm": in_millimeters(self.tip),
            "clearance_mm": MM_PER_M * self.tip_clearance,
            "depth_mm": MM_PER_M * self.depth,
        }


def refused_touch(
    now: TouchMoment,
    next_point: str,
    fiducials: Mapping[str, Vector],
    settings: TrainingSettings,
    method: RegistrationMethod,
) -> str | None:
    """Return why a touch does not count, None if it does; `fiducials` are in World, m."""
    away, radius = distance(now.tip, fiducials[next_point]), settings.radius(method)
    is_marked = method is RegistrationMethod.FIDUCIALS
    if away > radius:
        label = min(fiducials, key=lambda key: distance(now.tip, fiducials[key]))
        nearest = distance(now.tip, fiducials[label])
        if nearest <= radius:
            return say("wrong point", point=next_point, label=label, nearest=MM_PER_M * nearest)
        radius_mm, step = MM_PER_M * radius, 1 if is_marked else UNMARKED_STEP_MM
        away_mm = step * max(round(MM_PER_M * away / step), math.floor(radius_mm / step) + 1)
        most = max(TOLD_MM, TOLD_RADII * radius_mm)
        key = "too far" if away_mm <= most else "much too far"
        return say(key, point=next_point, distance=away_mm, most=f"{most:g}", radius=radius_mm)
    if settings.is_above(now):
        return say("above the skin", point=next_point, height=MM_PER_M * now.tip_clearance)
    return None


TOLD_MM, TOLD_RADII = 15.0, 1.5
"""A refusal tells how far away the point is up to here, or to so many times the distance at which
touches count: told from anywhere, three would lead to the point without a look at the head."""
UNMARKED_STEP_MM = 10
"""Where a point that is not marked is, is what the trainee has to know: its distance is rounded."""


_TOUCHING = (Phase.RUNNING, Phase.COMPLETE)
PRESSED_MM, TOO_DEEP_MM = 0.5, DEPTH_LIMIT_MM
"""How deep the tip may be pressed in before it is asked to ease off, and before it is an error."""


def touch_stage(
    now: TouchMoment,
    proximity: Proximity,
    obstacle: str,
    training: TrainingState,
    goal: Vector | None,
    settings: TrainingSettings,
) -> TouchStage:
    """Return the state of the next touch; `goal` is its place, World, m, None without one."""
    if proximity is not Proximity.CONTACT:
        if obstacle:
            return TouchStage.ARM
        return TouchStage.FAR if proximity is Proximity.FREE else TouchStage.NEAR
    if MM_PER_M * now.depth > TOO_DEEP_MM:
        return TouchStage.TOO_DEEP
    if MM_PER_M * now.tip_clearance > RELEASED_MM:
        return TouchStage.SHAFT
    if obstacle:
        return TouchStage.ARM
    is_on_skin = now.tip_clearance <= settings.skin_tolerance
    radius, is_open = settings.radius(training.method), training.phase in _TOUCHING
    is_traced = is_open and training.trace is not None and training.next_point is None
    if is_traced or (goal is not None and distance(now.tip, goal) <= radius):
        if not is_on_skin:
            return TouchStage.NEAR
        is_pressed = MM_PER_M * now.depth > PRESSED_MM
        return TouchStage.PRESSED if is_pressed else TouchStage.ON_SKIN
    # The tip still is where the last touch was made, or no trial is open.
    is_just_touched = any(distance(now.tip, t.position) <= radius for t in training.touches[-1:])
    return TouchStage.ELSEWHERE if is_open and not is_just_touched else TouchStage.NEAR
