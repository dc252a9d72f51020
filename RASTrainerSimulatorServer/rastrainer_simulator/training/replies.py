"""The outcome of a command of a trial, and the reply to it; what a registration reveals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from rastrainer.procedure.record import UsedRegistration
from rastrainer.protocol import Phase, RegistrationMethod
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import Event, EventKind, TrainingState, TrialResult
from rastrainer_simulator.texts.texts import say
from rastrainer_simulator.training.feed import Feed
from rastrainer_simulator.training.head_pose import Truth
from rastrainer_simulator.vectors import in_millimeters


@dataclass(frozen=True)
class TrainingReply:
    """The answer to a command; `feed` is the new feed in the guide, None if it stays.

    `data` of a refused touch describes the touch.
    """

    ok: bool
    message: str = ""
    data: Mapping[str, Any] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    feed: Feed | None = None


@dataclass(frozen=True)
class TrialStep:
    """The result of a command that is carried out.

    Attributes:
        key: of the instruction that goes with it.
        values: that are filled in.
        data: goes into the answer and the event, ready for JSON.
        recorded: goes into the event alone: clients never learn it.
        answered: goes into the answer alone.
        kind: of the event; an event of the phase follows any other if the phase changes.
        feed: the new feed in the guide; None if it stays.
    """

    state: TrainingState
    key: str
    values: Mapping[str, Any] = field(default_factory=dict)
    data: Mapping[str, Any] = field(default_factory=dict)
    recorded: Mapping[str, Any] = field(default_factory=dict)
    answered: Mapping[str, Any] = field(default_factory=dict)
    kind: EventKind = EventKind.PHASE
    feed: Feed | None = None


def summary(state: TrainingState) -> dict[str, Any]:
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
    """Return the points that register a trial: its touches and its trace, in double precision."""
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
            "simTimeS": touch.sim_time,
        }
        for touch in state.touches
    ]


def revealed(truth: Truth, state: TrainingState, matrix: tuple[float, ...]) -> dict[str, Any]:
    """Return the truth that a registration reveals; `matrix` is WorldToHead, 16 floats, mm."""
    touches = ((touch.label, in_millimeters(touch.position)) for touch in state.touches)
    return truth.revealed(np.array(matrix, dtype=float).reshape(4, 4), touches)


def trial_data(state: TrainingState, truth: Truth) -> dict[str, Any]:
    data = {**summary(state), **given(state)}
    if state.registration is not None:
        data.update(revealed(truth, state, state.registration.matrix))
    return data


def take_registration(
    arguments: Mapping[str, Any], state: TrainingState, truth: Truth
) -> TrialStep | TrainingReply:
    """Accept a registration, which becomes final, and reveal the truth; refuse any other."""
    known = state.registration
    registration = UsedRegistration.from_arguments(arguments)
    if known is not None and not known.agrees_with(registration):
        return TrainingReply(False, say("registration is final"))
    matrix = registration.matrix if known is None else known.matrix
    data, truth_data = {"trialId": state.trial_id}, revealed(truth, state, matrix)
    if known is not None:
        return TrainingReply(True, data={**data, **truth_data})
    key = "registered" if state.procedure is None else "procedure done"
    registered = replace(state, registration=registration)
    return TrialStep(registered, key, data=data, answered=truth_data, kind=EventKind.REGISTRATION)


def take_score(
    arguments: Mapping[str, Any], state: TrainingState, truth: Truth
) -> TrialStep | TrainingReply:
    """Accept the score of a registered trial; a repetition changes nothing."""
    registration, answered = state.registration, {"trialId": state.trial_id}
    if registration is None:
        return TrainingReply(False, say("no registration"))
    result = TrialResult(
        registration=registration,
        true_tre_mm=revealed(truth, state, registration.matrix)["trueTreMm"],
        score=arguments["score"],
        details=arguments["details"],
    )
    if result == state.result:
        return TrainingReply(True, data=answered)
    values = {"score": result.score, "fre": registration.fre_mm, "tre": result.true_tre_mm}
    scored = replace(state, phase=Phase.SCORED, result=result)
    return TrialStep(scored, "scored", values, answered=answered)
