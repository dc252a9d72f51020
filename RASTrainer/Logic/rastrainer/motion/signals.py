"""Evens out a recorded trajectory before anything is differentiated from it.

Differences of raw samples are no metric: 2 % of noise moves the log dimensionless jerk of a reach
from −5.3 to −15.
"""

from __future__ import annotations

import numpy as np
from numpy.fft import irfft, rfft, rfftfreq

from rastrainer.errors import InputError

CUTOFF_HZ = 6.0
"""Voluntary hand movement lies below this; the default of `low_pass`."""


def resample(times_s: np.ndarray, values: np.ndarray, rate_hz: float) -> np.ndarray:
    """Return the values at equal steps from the first to the last time, linearly interpolated.

    Args:
        times_s: (n,) float, strictly rising.
        values: (n, k) float.
        rate_hz: Samples a second of the result.

    Returns:
        (m, k) float.

    Raises:
        InputError: fewer than two samples, or times that do not rise.
    """
    times_s, values = np.asarray(times_s, dtype=float), np.asarray(values, dtype=float)
    if len(times_s) < 2 or not (np.diff(times_s) > 0).all():
        raise InputError("A trajectory needs at least two samples whose times rise.")
    count = int(np.floor((times_s[-1] - times_s[0]) * rate_hz + 1e-9)) + 1
    even = times_s[0] + np.arange(count) / rate_hz
    return np.column_stack([np.interp(even, times_s, column) for column in values.T])


def low_pass(values: np.ndarray, rate_hz: float, cutoff_hz: float = CUTOFF_HZ) -> np.ndarray:
    """Return the values without what is faster than the cutoff, undelayed.

    It is a second-order Butterworth filter run forth and back, as its gain 1/(1 + (f/fc)⁴) on the
    spectrum. The ends are continued by point reflection, which keeps straight lines straight.

    Args:
        values: (n, k) float, evenly sampled.
        rate_hz: Samples a second.
        cutoff_hz: Frequency at which half the amplitude is left.

    Returns:
        (n, k) float.
    """
    values = np.asarray(values, dtype=float)
    pad = min(len(values) - 1, int(np.ceil(3 * rate_hz / cutoff_hz)))
    if pad < 1:
        return values.copy()
    before = 2 * values[0] - values[pad:0:-1]
    after = 2 * values[-1] - values[-2 : -2 - pad : -1]
    padded = np.concatenate([before, values, after])
    # A straight line from end to end is taken off so that the spectrum sees no jump between them.
    line = np.linspace(padded[0], padded[-1], len(padded))
    spectrum = rfft(padded - line, axis=0)
    frequencies = rfftfreq(len(padded), 1 / rate_hz)
    gain = 1 / (1 + (frequencies / cutoff_hz) ** 4)
    filtered = irfft(spectrum * gain[:, None], len(padded), axis=0) + line
    return filtered[pad : pad + len(values)]


def speeds(positions_mm: np.ndarray, rate_hz: float) -> np.ndarray:
    """Return the speed at each sample, (n,) float, in mm/s, by central differences.

    Args:
        positions_mm: (n, 3) float, evenly sampled and low-pass filtered, n ≥ 2.
        rate_hz: Samples a second.
    """
    return np.linalg.norm(np.gradient(positions_mm, 1 / rate_hz, axis=0), axis=1)
