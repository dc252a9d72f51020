"""How punctual the control loop is, including ticks that it missed."""

from __future__ import annotations

from dataclasses import dataclass

LATE_S = 0.001
"""A tick that starts this much after its time counts as late."""


@dataclass(frozen=True)
class LoopStatistics:
    """Since the loop was started.

    Attributes:
        ticks: carried out.
        late: of these, started more than 1 ms after their time.
        skipped: never carried out, because the loop had fallen too far behind: the simulated
            clock has lost them.
        worst_delay_s: the longest time by which a tick was late.
    """

    ticks: int = 0
    late: int = 0
    skipped: int = 0
    worst_delay_s: float = 0.0

    @property
    def on_time(self) -> float:
        """Share of all ticks that were on time, 0…1; skipped ticks were not."""
        due = self.ticks + self.skipped
        return (self.ticks - self.late) / due if due else 1.0

    def since(self, earlier: LoopStatistics) -> LoopStatistics:
        """Return the counts after an earlier moment; the longest delay is that of both together."""
        return LoopStatistics(
            self.ticks - earlier.ticks,
            self.late - earlier.late,
            self.skipped - earlier.skipped,
            self.worst_delay_s,
        )


class Punctuality:
    """Counts for `LoopStatistics`, in the control loop's thread."""

    def __init__(self) -> None:
        self._ticks = 0
        self._late = 0
        self._skipped = 0
        self._worst = 0.0

    def count(self, delay: float) -> None:
        """Count a tick that starts `delay` seconds after its time."""
        self._ticks += 1
        if delay > LATE_S:
            self._late += 1
        if delay > self._worst:
            self._worst = delay

    def skip(self, ticks: int) -> None:
        """Count ticks that are given up."""
        self._skipped += ticks

    def statistics(self) -> LoopStatistics:
        """Return the counts."""
        return LoopStatistics(self._ticks, self._late, self._skipped, self._worst)
