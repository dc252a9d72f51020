"""What a trial has from its start: ID and seed, task, head and first state; its clock; its pauses.

It also has every earlier state, to go back to what is on the disk.
"""

from __future__ import annotations

import hashlib
import uuid
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from rastrainer.head.trial_head import SkinShift
from rastrainer.json_records import record_from_json
from rastrainer.protocol import PROCEDURE_PHASES, TRACED_METHODS, Phase
from rastrainer.scenario.scenario import method_of, task_by_method
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training import tracing
from rastrainer_simulator.training.feed import Feed, ProcedureSettings
from rastrainer_simulator.training.head_pose import PlacedHead
from rastrainer_simulator.training.procedure_phases import ProcedurePhases
from rastrainer_simulator.training.replies import TrialStep
from rastrainer_simulator.training.rules import TrainingSettings
from rastrainer_simulator.trial_state import ProcedureState, TraceState

if TYPE_CHECKING:
    from rastrainer.scenario.points import Task
    from rastrainer.scenario.scenario import Scenario

DRAWN_SEED = "drawnSeed"
"""Argument of StartTask where a recorded trial begins again: its seed, which no client chose."""


def trial_seed(seed: int, number: int) -> int:
    """Return the seed of a session's `number`-th trial, 0 … 2^53 − 1 (exact in any JSON reader)."""
    return int.from_bytes(_digest("seed", seed, number)[:8], "big") >> 11


def trial_id(seed: int, number: int) -> str:
    """Return the ID of a session's `number`-th trial, shaped like a random UUID (version 4)."""
    return str(uuid.UUID(bytes=_digest("id", seed, number)[:16], version=4))


def _digest(what: str, seed: int, number: int) -> bytes:
    return hashlib.sha256(f"{what}:{seed}:{number}".encode()).digest()


@dataclass(frozen=True)
class StartedTrial:
    """A trial as StartTask makes it; its seed is as secret as the head's pose."""

    seed: int
    task: Task
    head: PlacedHead
    phases: ProcedurePhases | None
    state: TrainingState


class TrialStarter:
    """Starts the trials of a session, each with its own ID and seed."""

    def __init__(
        self,
        scenario: Scenario,
        seed: int,
        settings: TrainingSettings,
        procedure: ProcedureSettings,
    ) -> None:
        self._scenario = scenario
        self._seed = seed
        self._settings = settings
        self._procedure_settings = procedure
        self._number = 0

    def start(self, arguments: Mapping[str, Any], revision: int) -> StartedTrial:
        """Return a trial by the arguments of StartTask; `revision` is the last one before it."""
        number, procedure = self._number, arguments.get("procedure") or ""
        chosen_skin = arguments.get("skin")
        skin = record_from_json(SkinShift, chosen_skin) if chosen_skin else self._scenario.skin
        method = method_of(arguments.get("method"))
        task = task_by_method(self._scenario, arguments["task"], method)
        phases = None
        if procedure:
            plan, settings = self._scenario.procedure(procedure), self._procedure_settings
            phases = ProcedurePhases(plan, task.labels, self._settings, settings)
        chosen = arguments.get("seed")
        if chosen is None:
            chosen = arguments.get(DRAWN_SEED)
        seed = trial_seed(self._seed, number) if chosen is None else chosen
        head = PlacedHead.of_trial(self._scenario, task, seed, skin)
        self._number += 1
        state = TrainingState(
            phase=Phase.RUNNING,
            trainee=arguments["trainee"],
            task=task.name,
            mode=arguments["mode"],
            trial_id=arguments.get("trialId") or trial_id(self._seed, number),
            next_point=task.labels[0],
            revision=revision,
            procedure=ProcedureState(procedure) if procedure else None,
            method=method,
            trace=TraceState() if method in TRACED_METHODS else None,
        )
        return StartedTrial(seed, task, head, phases, state)


class TrialClock:
    """Counts a trial's time; `now` is the simulated time in s."""

    def __init__(self, now: float) -> None:
        self._start = now
        self._paused = 0.0
        self._paused_since: float | None = None

    def pause(self, now: float) -> None:
        if self._paused_since is None:
            self._paused_since = now

    def resume(self, now: float) -> None:
        if self._paused_since is not None:
            self._paused += now - self._paused_since
            self._paused_since = None

    def time_of(self, state: TrainingState, now: float) -> float:
        """Return the time of a trial, which ends with its last point or with its procedure, s."""
        phase, procedure = state.phase, state.procedure
        if phase is Phase.IDLE:
            return 0.0
        if procedure is not None and procedure.ended_s is not None:
            return procedure.ended_s
        if procedure is not None or phase in (Phase.RUNNING, Phase.PAUSED):
            return self.elapsed(now)
        return state.completed_s

    def elapsed(self, now: float) -> float:
        """Return the time that has been counted, s."""
        until = now if self._paused_since is None else self._paused_since
        return until - self._start - self._paused


def paused(state: TrainingState) -> TrainingState:
    """Return the state of a trial that is paused; no stroke is being drawn."""
    return replace(tracing.ended(state), phase=Phase.PAUSED)


def resumed(state: TrainingState) -> TrialStep:
    """Return the step by which the touches or the trace of a paused trial continue."""
    running, trace = replace(state, phase=Phase.RUNNING), state.trace
    if trace is None or state.next_point is not None:
        return TrialStep(running, "resumed")
    again = tracing.ended(running)
    return TrialStep(again, tracing.instruction(again), tracing.counts(trace))


def interrupted(state: TrainingState) -> TrialStep:
    """Return the step by which a trial waits after the server's end: paused, unless complete."""
    trace, procedure = state.trace, state.procedure
    values = {} if trace is None else tracing.counts(trace)
    if state.phase is Phase.COMPLETE:
        key = "interrupted complete" if trace is None else "interrupted trace"
        return TrialStep(state, key, values)
    if procedure is not None and procedure.stage in PROCEDURE_PHASES:
        key = "interrupted procedure"
    else:
        key = "interrupted" if state.next_point is not None else "interrupted trace"
    return TrialStep(paused(state), key, {"kept": len(state.touches), **values})


class KeptStates:
    """Every state of the present trial by its revision, and the feed at which it was left."""

    def __init__(self) -> None:
        self._states: dict[int, TrainingState] = {}
        self._feeds: dict[int, Feed] = {}

    def begin(self, *states: TrainingState) -> None:
        """Forget all states but these."""
        self._states = {state.revision: state for state in states}
        self._feeds = {}

    def keep(self, state: TrainingState) -> None:
        self._states[state.revision] = state

    def leave(self, revision: int, feed: Feed) -> None:
        self._feeds[revision] = feed

    def find(self, revision: int) -> tuple[TrainingState, Feed | None] | None:
        """Return a revision's state, and the feed at which it was left, None of the present one."""
        state = self._states.get(revision)
        return None if state is None else (state, self._feeds.get(revision))
