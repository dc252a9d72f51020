"""Replies to the commands of a trial, and what they and events tell of it, in mm."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

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
    told: dict[str, Any] = {
        "trialId": state.trial_id,
        "phase": state.phase.value,
        "trainee": state.trainee,
        "task": state.task,
        "mode": state.mode,
        "nextPoint": state.next_point,
    }
    if state.procedure is not None:
        at = {"name": state.procedure.name, "stage": state.procedure.stage.value}
        told["procedure"] = {**at, "trajectory": state.procedure.trajectory}
    return told


def touched(state: TrainingState) -> list[dict[str, Any]]:
    """Return the touches of a trial, in double precision."""
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
