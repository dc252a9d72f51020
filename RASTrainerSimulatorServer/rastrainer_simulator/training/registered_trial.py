"""A trial that is registered: by what, the truth that this reveals, and the score."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.ops.texts.texts import Texts
from rastrainer_simulator.registration_state import FinalRegistration
from rastrainer_simulator.state import EventKind, TrainingState, TrialResult
from rastrainer_simulator.training.replies import TrainingReply, TrialStep, summary
from rastrainer_simulator.training.true_error import Truth
from rastrainer_simulator.vectors import in_millimeters


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
    touches = ((touch.label, in_millimeters(touch.position)) for touch in state.touches)
    return truth.revealed(np.array(matrix, dtype=float).reshape(4, 4), touches)


def trial_data(state: TrainingState, truth: Truth) -> dict[str, Any]:
    """Return the answer to GetTrial of the present trial; the truth once it is revealed."""
    data = {**summary(state), **given(state)}
    if state.registration is not None:
        data.update(revealed(truth, state, state.registration.matrix))
    return data


def take_registration(
    arguments: Mapping[str, Any], state: TrainingState, truth: Truth, texts: Texts
) -> TrialStep | TrainingReply:
    """Accept a registration, which becomes final, and reveal the truth; refuse any other."""
    known = state.registration
    registration = FinalRegistration.from_arguments(arguments)
    if known is not None and not known.agrees_with(registration):
        return TrainingReply(False, texts.say("registration is final"))
    matrix = registration.matrix if known is None else known.matrix
    data, truth_data = {"trialId": state.trial_id}, revealed(truth, state, matrix)
    if known is not None:
        return TrainingReply(True, data={**data, **truth_data})
    key = "registered" if state.procedure is None else "procedure done"
    registered = replace(state, registration=registration)
    return TrialStep(registered, key, data=data, answered=truth_data, kind=EventKind.REGISTRATION)


def take_score(
    arguments: Mapping[str, Any], state: TrainingState, truth: Truth, texts: Texts
) -> TrialStep | TrainingReply:
    """Take the score of a registered trial; the same again changes nothing."""
    registration, answered = state.registration, {"trialId": state.trial_id}
    if registration is None:
        return TrainingReply(False, texts.say("no registration"))
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
