"""The outcome of a command of a trial, and the reply to it; what a registration reveals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from rastrainer.journal.entries import (
    Ahead,
    Entry,
    FinalRegistration,
    PhaseChange,
    ProcedureAt,
)
from rastrainer.json_records import record_to_json
from rastrainer.procedure.record import UsedRegistration
from rastrainer.protocol import Phase, RegistrationMethod
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import Event, TrainingState, TrialResult
from rastrainer_simulator.texts.texts import say
from rastrainer_simulator.training.feed import NO_FEED, Feed
from rastrainer_simulator.training.head_pose import Truth
from rastrainer_simulator.vectors import in_millimeters


@dataclass(frozen=True)
class TrainingReply:
    """The answer to a command; `feed` is the new feed in the guide, None if it stays.

    A refused touch is an event, too.
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
        entry: what happened. It goes into the answer, too, unless it is a registration, and a
            change of the phase follows if there is one; None if that change is all.
        data: of the change of the phase, by the names of `PhaseChange`; goes into the answer, too.
        ahead: goes into the change of the phase: clients never learn it.
        answered: goes into the answer alone.
        feed: the new feed in the guide; None if it stays.
        has_summary: whether the answer to a change of the phase also has the trial's summary.
    """

    state: TrainingState
    key: str
    values: Mapping[str, Any] = field(default_factory=dict)
    entry: Entry | None = None
    data: Mapping[str, Any] = field(default_factory=dict)
    ahead: Ahead | None = None
    answered: Mapping[str, Any] = field(default_factory=dict)
    feed: Feed | None = None
    has_summary: bool = True


def phase_change(state: TrainingState, feed: Feed = NO_FEED, **data: Any) -> PhaseChange:
    procedure, trace, is_drilled = state.procedure, state.trace, feed.drilled > 0.0
    at = None
    if procedure is not None:
        at = ProcedureAt(procedure.name, procedure.stage, procedure.trajectory)
    return PhaseChange(
        trial_id=state.trial_id,
        phase=state.phase,
        trainee=state.trainee,
        task=state.task,
        mode=state.mode,
        next_point=state.next_point,
        procedure=at,
        method=None if state.method is RegistrationMethod.FIDUCIALS else state.method,
        traced=None if trace is None else len(trace.points),
        instruction=state.instruction,
        feed_mm=MM_PER_M * feed.depth if is_drilled else None,
        drilled_mm=MM_PER_M * feed.drilled if is_drilled else None,
        **data,
    )


def summary(state: TrainingState, **data: Any) -> dict[str, Any]:
    """Return the state of a trial as clients learn it, ready for JSON."""
    values = record_to_json(phase_change(state, **data))
    del values["instruction"]
    return values


def given(state: TrainingState) -> dict[str, Any]:
    """Return the points that register a trial: its touches and its trace, in double precision."""
    touches = [
        {
            "label": touch.label,
            "positionMm": [MM_PER_M * value for value in touch.position],
            "simTimeS": touch.sim_time,
        }
        for touch in state.touches
    ]
    if state.trace is None:
        return {"touches": touches}
    points = state.trace.points
    traced = [[*(MM_PER_M * x for x in point.position), point.sim_time] for point in points]
    return {"touches": touches, "trace": traced}


def revealed(truth: Truth, state: TrainingState, matrix: tuple[float, ...]) -> dict[str, Any]:
    """Return the truth that a registration reveals; `matrix` is WorldToHead, 16 floats, mm."""
    touches = ((touch.label, in_millimeters(touch.position)) for touch in state.touches)
    return truth.revealed(matrix, touches)


def trial_data(state: TrainingState, truth: Truth) -> dict[str, Any]:
    data = {**summary(state), **given(state)}
    if state.registration is not None:
        data.update(revealed(truth, state, state.registration.matrix))
    return data


def take_registration(
    arguments: Mapping[str, Any], sender: str, state: TrainingState, truth: Truth
) -> TrialStep | TrainingReply:
    """Accept a registration, which becomes final, and reveal the truth; refuse any other."""
    known = state.registration
    registration = UsedRegistration.from_arguments(arguments)
    if known is not None and not known.agrees_with(registration):
        return TrainingReply(False, say("registration is final"))
    matrix = registration.matrix if known is None else known.matrix
    answered = {"trialId": state.trial_id, **revealed(truth, state, matrix)}
    if known is not None:
        return TrainingReply(True, data=answered)
    key = "registered" if state.procedure is None else "procedure done"
    registered = replace(state, registration=registration)
    return TrialStep(registered, key, entry=FinalRegistration(sender, arguments), answered=answered)


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
    return TrialStep(scored, "scored", values, answered=answered, has_summary=False)
