"""A trial's clock, how it pauses and resumes, and the states to which it can go back."""

from __future__ import annotations

from dataclasses import replace

from rastrainer.protocol import PROCEDURE_PHASES, Phase
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training import tracing
from rastrainer_simulator.training.feed import Feed
from rastrainer_simulator.training.replies import TrialStep


class TrialClock:
    """Counts a trial's time; `now` is the simulated time in s."""

    def __init__(self, now: float) -> None:
        self._start = now
        self._paused = 0.0
        self._paused_since: float | None = None

    def pause(self, now: float) -> None:
        """Stop counting."""
        if self._paused_since is None:
            self._paused_since = now

    def resume(self, now: float) -> None:
        """Count again."""
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
        """Keep a state that the trial takes on."""
        self._states[state.revision] = state

    def leave(self, revision: int, feed: Feed) -> None:
        """Keep the feed at which the state of a revision is left."""
        self._feeds[revision] = feed

    def find(self, revision: int) -> tuple[TrainingState, Feed | None] | None:
        """Return the state of a revision and the feed at which it was left, None if it is present.

        None instead of both if there is no such state.
        """
        state = self._states.get(revision)
        return None if state is None else (state, self._feeds.get(revision))
