"""What a constant offset does to throughput, in our variant and by the standard's width."""

from __future__ import annotations

import numpy as np

from rastrainer.motion.throughput import WIDTH_FACTOR, effective_throughput
from rastrainer.number_text import fixed
from Testing.error_rates.measured import Measured, share_of

HEADER = (
    "offset of all end points, scatter 0.05 mm",
    "trials above 8 bit/s",
    "mean, bit/s",
    "mean by SD about the mean (ISO), bit/s",
)
DISTANCE_MM, TOUCHES = 80.0, 15


def offsets(sets: int, seed: int = 8) -> list[Measured]:
    """Return the throughput of trials with a touch a second, each `DISTANCE_MM` from the last."""
    random = np.random.default_rng(seed)
    found = []
    for offset in (0.0, 0.5, 2.0, 5.0):
        rates, by_sd = [], []
        for _ in range(sets):
            ours, standard = _trial(offset, random)
            rates.append(ours)
            by_sd.append(standard)
        beside = fixed(float(np.mean(rates)), 2), fixed(float(np.mean(by_sd)), 2)
        above = share_of(np.array(rates) > 8)
        limit = 0.0 if offset else None
        found.append(Measured(f"{offset:g} mm", above, sets, at_most=limit, beside=beside))
    return found


def _trial(offset: float, random: np.random.Generator) -> tuple[float, float]:
    """Return our throughput and the standard's, of targets on a line that is gone to and fro."""
    there = DISTANCE_MM * (np.arange(TOUCHES) % 2)
    ahead = np.where(np.arange(TOUCHES) % 2, 1.0, -1.0)
    beside = (offset + random.normal(0, 0.05, TOUCHES)) * ahead
    targets, touches = (
        np.column_stack([x, np.zeros((TOUCHES, 2))]) for x in (there, there + beside)
    )
    result = effective_throughput(targets, touches, np.arange(float(TOUCHES)))
    width = WIDTH_FACTOR * np.std((beside * ahead)[1:], ddof=1)
    standard = np.log2(np.array(result.effective_distances_mm) / width + 1).mean()
    return result.bits_per_s, float(standard)
