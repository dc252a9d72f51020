"""Tracing: where the tip leaves a point, what ends a stroke, and the messages about it.

A point is left where the tip is on the skin, a millimeter or more from the last one. That follows
from the last point alone, so that an interrupted trial continues exactly as it would have.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from rastrainer.journal.entries import Stroke
from rastrainer.protocol import MIN_TRACE_POINTS, TRACE_SPACING_MM, Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training.replies import TrialStep
from rastrainer_simulator.training.rules import PRESSED_MM, TouchMoment, TrainingSettings
from rastrainer_simulator.trial_state import TraceState
from rastrainer_simulator.vectors import Vector, distance, in_millimeters


def takes_point(trace: TraceState | None, now: TouchMoment, settings: TrainingSettings) -> bool:
    """Return whether the tip leaves a point: on the skin, by any rule, and not pressed in."""
    if trace is None or not trace.is_on or now.tip_clearance > settings.skin_tolerance:
        return False
    if MM_PER_M * now.depth > PRESSED_MM:
        return False
    last = trace.points[-1:]
    return not last or MM_PER_M * distance(now.tip, last[0].seen) >= TRACE_SPACING_MM


def tip_places(tip: Vector, measured: Vector) -> dict[str, Any]:
    """Return where the tip is, mm, and where it is measured, if that is elsewhere."""
    elsewhere = None if measured == tip else in_millimeters(measured)
    return {"position_mm": in_millimeters(tip), "measured_mm": elsewhere}


def stroke_entry(trace: TraceState, undone: bool = False) -> Stroke:
    return Stroke(trace.is_on, len(trace.points), len(trace.strokes), undone)


def stroke(state: TrainingState, trace: TraceState, undone: bool = False) -> TrialStep:
    """Return the step by which a stroke begins, has ended or is undone, as its trace says."""
    may_register = state.next_point is None and trace.is_enough and not trace.is_on
    phase = Phase.COMPLETE if may_register else Phase.RUNNING
    changed = replace(state, phase=phase, trace=trace)
    entry = stroke_entry(trace, undone)
    return TrialStep(changed, instruction(changed), counts(trace), entry)


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
