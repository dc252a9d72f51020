"""What a command of a trial leads to, and the reply to it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rastrainer.protocol import RegistrationMethod
from rastrainer_simulator.state import Event, EventKind, TrainingState
from rastrainer_simulator.training.feed import Feed


@dataclass(frozen=True)
class TrainingReply:
    """What a command led to; `feed` is what is in the guide from now on, None as before."""

    ok: bool
    message: str = ""
    data: Mapping[str, Any] = field(default_factory=dict)
    events: tuple[Event, ...] = ()
    feed: Feed | None = None


@dataclass(frozen=True)
class TrialStep:
    """What a command leads to.

    Attributes:
        state: of the trial.
        key: of the instruction that goes with it.
        values: that are filled in.
        data: goes into the answer and the event, ready for JSON.
        recorded: goes into the event alone: clients never learn it.
        answered: goes into the answer alone.
        kind: of the event; another than that of a phase is followed by one if the phase changes.
        feed: what is in the guide from now on; None as before.
    """

    state: TrainingState
    key: str
    values: Mapping[str, Any] = field(default_factory=dict)
    data: Mapping[str, Any] = field(default_factory=dict)
    recorded: Mapping[str, Any] = field(default_factory=dict)
    answered: Mapping[str, Any] = field(default_factory=dict)
    kind: EventKind = EventKind.PHASE
    feed: Feed | None = None


@dataclass(frozen=True)
class RefusedStep:
    """Why a command is refused; `data` is that of a touch that does not count."""

    sentence: str
    data: Mapping[str, Any] | None = None


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
