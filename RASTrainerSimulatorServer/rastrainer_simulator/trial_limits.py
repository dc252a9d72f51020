"""How often trials may be begun, as settings with sane defaults."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class TrialLimits:
    """Limits of the trials, whoever begins them; further ones are refused.

    Each makes a journal, and to begin it is as much work as several ticks.

    Attributes:
        starts_per_s: trials that may be begun in a simulated second, on average, and
        starts_at_once: so many at once after a pause.
    """

    starts_per_s: float = 0.2
    starts_at_once: int = 4
