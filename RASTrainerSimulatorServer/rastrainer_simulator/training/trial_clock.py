"""The time of a trial: simulated seconds since its start, pauses left out."""

from __future__ import annotations


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
