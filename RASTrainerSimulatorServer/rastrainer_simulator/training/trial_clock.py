"""A trial's clock, its seed and ID, and the states to which it can go back."""

from __future__ import annotations

import hashlib
import uuid

from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.training.feed import Feed


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
        """Stop counting."""
        if self._paused_since is None:
            self._paused_since = now

    def resume(self, now: float) -> None:
        """Count again."""
        if self._paused_since is not None:
            self._paused += now - self._paused_since
            self._paused_since = None

    def elapsed(self, now: float) -> float:
        """Return the trial's time in s."""
        until = now if self._paused_since is None else self._paused_since
        return until - self._start - self._paused


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
