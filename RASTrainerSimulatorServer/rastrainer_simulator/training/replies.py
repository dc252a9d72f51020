"""Replies to the commands of a trial, and what they and events say about it, in mm."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rastrainer.registration.methods import RegistrationMethod
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import Event, TrainingState
from rastrainer_simulator.training.feed import Feed
from rastrainer_simulator.training.true_error import Truth
from rastrainer_simulator.vectors import vector


@dataclass(frozen=True)
class TrainingReply:
    """What a command led to; `feed` is what is in the guide from now on, None as before."""

    ok: bool
    message: str = ""
    data: Mapping[str, Any] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    feed: Feed | None = None


def summary(state: TrainingState) -> dict[str, Any]:
    """Return where a trial stands."""
    data: dict[str, Any] = {
        "trialId": state.trial_id,
        "phase": state.phase.value,
        "trainee": state.trainee,
        "task": state.task,
        "mode": state.mode,
        "nextPoint": state.next_point,
    }
    if state.procedure is not None:
        at = {"name": state.procedure.name, "stage": state.procedure.stage.value}
        data["procedure"] = {**at, "trajectory": state.procedure.trajectory}
    if state.method is not RegistrationMethod.FIDUCIALS:
        # As in journals older than methods.
        data["method"] = state.method.value
    if state.trace is not None:
        data["traced"] = len(state.trace.points)
    return data


def given(state: TrainingState) -> dict[str, Any]:
    """Return what a trial is registered by: its touches and its trace, in double precision."""
    trace = state.trace
    if trace is None:
        return {"touches": _touched(state)}
    traced = [[*(MM_PER_M * x for x in p.position), p.sim_time] for p in trace.points]
    return {"touches": _touched(state), "trace": traced}


def _touched(state: TrainingState) -> list[dict[str, Any]]:
    return [
        {
            "label": touch.label,
            "positionMm": [MM_PER_M * value for value in touch.position],
            "simTime": touch.sim_time,
        }
        for touch in state.touches
    ]


def revealed(truth: Truth, state: TrainingState, matrix: tuple[float, ...]) -> dict[str, Any]:
    """Return the truth that a registration reveals; `matrix` is WorldToHead, 16 floats, mm."""
    touches = (
        (touch.label, vector(MM_PER_M * value for value in touch.position))
        for touch in state.touches
    )
    return truth.revealed(np.array(matrix, dtype=float).reshape(4, 4), touches)
