"""Motion metrics of a trial: how far, how directly and how steadily the tool moved."""

from __future__ import annotations

import numpy as np

from rastrainer.errors import InputError

IDLE_SPEED_MM_S = 1.0
IDLE_DURATION_S = 0.3


def path_length(positions_mm: np.ndarray) -> float:
    """Return the length of the path through (n, 3) float positions, in mm.

    Resample and filter first (`rastrainer.motion.signals`): tremor of the samples would add up.
    """
    return float(np.linalg.norm(np.diff(positions_mm, axis=0), axis=1).sum())


def path_efficiency(actual_mm: float, shortest_mm: float) -> float:
    """Return the shortest collision-free length over the actual length; 1 is direct.

    Raises:
        InputError: a length is not above 0.
    """
    if not (actual_mm > 0 and shortest_mm > 0):
        raise InputError("Path efficiency needs two lengths above 0 mm.")
    return shortest_mm / actual_mm


def idle_time(
    speed_mm_s: np.ndarray,
    rate_hz: float,
    threshold_mm_s: float = IDLE_SPEED_MM_S,
    shortest_s: float = IDLE_DURATION_S,
) -> float:
    """Return how long the tool rested, in s: below the threshold for longer than `shortest_s`.

    Args:
        speed_mm_s: (n,) float, evenly sampled.
        rate_hz: Samples a second.
        threshold_mm_s: Speed below which the tool rests.
        shortest_s: Shorter rests do not count.
    """
    resting = np.concatenate([[False], np.asarray(speed_mm_s) < threshold_mm_s, [False]])
    changes = np.flatnonzero(np.diff(resting.astype(int)))
    durations = (changes[1::2] - changes[0::2]) / rate_hz
    return float(durations[durations > shortest_s].sum())
