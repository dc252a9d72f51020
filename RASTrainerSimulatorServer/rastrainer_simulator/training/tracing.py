"""Tracing: where the tip leaves a point, what ends a stroke, and the messages about it.

A point is left where the tip is on the skin, a millimeter or more from the last one. That follows
from the last point alone, so that an interrupted trial continues exactly as it would have.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from rastrainer.journal.entries import Stroke, TracePoint
from rastrainer.protocol import MIN_TRACE_POINTS, TRACE_SPACING_MM, Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import Event, TrainingState
from rastrainer_simulator.training.replies import TrialStep
from rastrainer_simulator.training.rules import PRESSED_MM, TouchMoment, TrainingSettings
from rastrainer_simulator.trial_state import TracedPoint, TraceState
from rastrainer_simulator.vectors import Vector, distance, in_millimeters


def takes_point(trace: TraceState | None, now: TouchMoment, settings: TrainingSettings) -> bool:
    """Return whether the tip leaves a point: on the skin, whatever the rule, and not pressed in."""
    if trace is None or not trace.is_on or now.tip_clearance > settings.skin_tolerance:
        return False
    if MM_PER_M * now.depth > PRESSED_MM:
        return False
    last = trace.points[-1:]
    return not last or MM_PER_M * distance(now.tip, last[0].seen) >= TRACE_SPACING_MM


def with_point(
    state: TrainingState, now: TouchMoment, measured: Vector, elapsed: float
) -> TrainingState:
    """Return a trial's state with a point at the tip; `elapsed` is the trial's time, s."""
    assert state.trace is not None
    tip = None if measured == now.tip else now.tip
    point = TracedPoint(measured, now.sim_time, elapsed, tip)
    return replace(state, trace=state.trace.with_point(point))


def point_event(state: TrainingState, now: TouchMoment) -> Event:
    assert state.trace is not None
    place = tip_places(now.tip, state.trace.points[-1].position)
    return Event(now.sim_time, TracePoint(**place, kept=len(state.trace.points)))


def tip_places(tip: Vector, measured: Vector) -> dict[str, Any]:
    """Return where the tip is, mm, and where it is measured, if that is elsewhere."""
    elsewhere = None if measured == tip else in_millimeters(measured)
    return {"position_mm": in_millimeters(tip), "measured_mm": elsewhere}


def stroke_entry(trace: TraceState, undone: bool = False) -> Stroke:
    """Return the entry of a trace where a stroke begins, ends or is undone."""
    return Stroke(trace.is_on, len(trace.points), len(trace.strokes), undone)


def stroke(state: TrainingState, undone: bool = False) -> TrialStep:
    assert state.trace is not None
    entry = stroke_entry(state.trace, undone)
    return TrialStep(state, instruction(state), counts(state.trace), entry)


def begun(state: TrainingState) -> TrainingState:
    assert state.trace is not None
    return replace(state, phase=Phase.RUNNING, trace=state.trace.begun())


def ended(state: TrainingState) -> TrainingState:
    """Return the state of a trial in which no stroke is being drawn; what was drawn is kept."""
    if state.trace is None:
        return state
    return _with_rest(state, state.trace.ended())


def undone(state: TrainingState) -> TrainingState:
    assert state.trace is not None
    return _with_rest(state, state.trace.undone())


def _with_rest(state: TrainingState, trace: TraceState) -> TrainingState:
    may_register = state.next_point is None and trace.is_enough
    return replace(state, phase=Phase.COMPLETE if may_register else Phase.RUNNING, trace=trace)


def instruction(state: TrainingState) -> str:
    """Return the key of the instruction to a trainee who traces, or may; `counts` fills it in."""
    trace = state.trace
    assert trace is not None
    if trace.is_on:
        return "tracing"
    if trace.is_full:
        return "traced all"
    if trace.is_enough:
        return "traced enough"
    return "traced" if trace.points else "trace"


def counts(trace: TraceState) -> dict[str, int]:
    return {"traced": len(trace.points), "least": MIN_TRACE_POINTS}
