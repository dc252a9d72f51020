"""A trial's ID and seed, its clock, its pauses and interruptions."""

from __future__ import annotations

import hashlib
import uuid
from dataclasses import replace

from rastrainer.protocol import PROCEDURE_PHASES, Phase
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training import tracing
from rastrainer_simulator.training.replies import TrialStep

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
        until = now if self._paused_since is None else self._paused_since
        return until - self._start - self._paused


def paused(state: TrainingState) -> TrainingState:
    trace = None if state.trace is None else state.trace.ended()
    return replace(state, phase=Phase.PAUSED, trace=trace)


def resumed(state: TrainingState) -> TrialStep:
    if state.trace is None or state.next_point is not None:
        return TrialStep(replace(state, phase=Phase.RUNNING), "resumed", has_summary=False)
    stroke = tracing.stroke(state, state.trace.ended())
    return replace(stroke, entry=None, has_summary=False)


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
