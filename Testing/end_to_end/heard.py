"""What SDL has played into a file: sounds are looked for by matched filter."""

from __future__ import annotations

import wave
from pathlib import Path

import numpy as np
from scipy.signal import oaconvolve, resample_poly

from rastrainer_simulator.assets import asset_path

PLAYED_HZ, STORED_HZ = 44_100, 32_000
APART_S = 0.1
"""Nearer than this two matches are one sound."""
BYTES_A_SECOND = PLAYED_HZ * 2 * 2
"""Of 16-bit samples in two channels."""


def times_heard(path: Path, name: str, volume: float = 0.8) -> int:
    """Return how often a sound was played at a volume, whatever else was to be heard then."""
    samples = np.fromfile(path, "<i2").reshape(-1, 2)[:, 0].astype(float)
    with wave.open(str(asset_path("sounds", f"{name}.wav"))) as file:
        stored = np.frombuffer(file.readframes(file.getnframes()), "<i2").astype(float)
    pattern = resample_poly(stored, PLAYED_HZ, STORED_HZ)
    # The factor by which the sound must be multiplied to be most like what was heard.
    loudness = oaconvolve(samples, pattern[::-1], "valid") / (pattern @ pattern)
    starts = np.flatnonzero(loudness > 0.75 * volume)
    return np.count_nonzero(np.diff(starts, prepend=-PLAYED_HZ) > APART_S * PLAYED_HZ)
