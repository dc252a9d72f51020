"""A trial's clock, and the seeds and IDs of trials, which follow from the simulator's seed."""

from __future__ import annotations

import hashlib
import uuid


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
