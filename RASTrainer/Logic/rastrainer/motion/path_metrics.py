"""Path, rest and smoothness of the tool's movement, and the filter applied before them.

Raw samples are resampled and filtered before differentiation: 2 % of noise changes the log
dimensionless jerk of a reach from −5.3 to −15.
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
    """Return the values low-pass filtered without delay.

    The gain 1/(1 + (f/fc)⁴) on the spectrum is that of a second-order Butterworth filter run
    forward and backward. The ends are extended by point reflection, which keeps straight lines
    straight.

    Args:
        values: (n, k) float, evenly sampled.
        rate_hz: Sampling rate.
        cutoff_hz: Frequency at which half the amplitude remains.

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
    # Subtract the line between the ends, so that the spectrum has no jump.
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


IDLE_SPEED_MM_S = 1.0
IDLE_DURATION_S = 0.3


def path_length(positions_mm: np.ndarray) -> float:
    """Return the length of the path through (n, 3) float positions, in mm.

    Resample and filter first: tremor of the samples would add up.
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
    """Return the total time in s of rests: below the threshold for longer than `shortest_s`.

    Args:
        speed_mm_s: (n,) float, evenly sampled.
        rate_hz: Sampling rate.
        threshold_mm_s: Speed below which the tool rests.
        shortest_s: Shorter rests are ignored.
    """
    resting = np.concatenate([[False], np.asarray(speed_mm_s) < threshold_mm_s, [False]])
    changes = np.flatnonzero(np.diff(resting.astype(int)))
    durations = (changes[1::2] - changes[0::2]) / rate_hz
    return float(durations[durations > shortest_s].sum())


SPARC_CUTOFF_HZ = 10.0
SPARC_THRESHOLD = 0.05
SPARC_PAD_LEVEL = 4


def sparc(speed: np.ndarray, rate_hz: float) -> float:
    """Return the spectral arc length (Balasubramanian et al. 2015), dimensionless and below 0.

    The length of the curve of the speed's magnitude spectrum, scaled to 1 at its peak, up to the
    last frequency of at most 10 Hz where it reaches 0.05. The zero padding is theirs: four more
    powers of two.

    Args:
        speed: (n,) float of one movement, evenly sampled.
        rate_hz: Samples a second.

    Raises:
        InputError: fewer than four samples, or nothing moves.
    """
    speed = _checked(speed)
    length = 2 ** (int(np.ceil(np.log2(len(speed)))) + SPARC_PAD_LEVEL)
    magnitude = np.abs(rfft(speed, length))
    magnitude /= magnitude.max()
    frequency = rfftfreq(length, 1 / rate_hz)
    kept = np.flatnonzero((frequency <= SPARC_CUTOFF_HZ) & (magnitude >= SPARC_THRESHOLD))
    band = slice(kept[0], kept[-1] + 1)
    along = np.diff(frequency[band]) / (frequency[kept[-1]] - frequency[kept[0]])
    return -float(np.hypot(along, np.diff(magnitude[band])).sum())


def log_dimensionless_jerk(speed: np.ndarray, rate_hz: float) -> float:
    """Return −ln(T³/v²ₚₑₐₖ · ∫ v̈² dt) (Balasubramanian et al. 2012), dimensionless.

    A reach of minimum jerk has −ln 204.8 = −5.322.

    Args:
        speed: (n,) float of one movement, evenly sampled and low-pass filtered.
        rate_hz: Samples a second.

    Raises:
        InputError: fewer than four samples, or the speed does not change.
    """
    speed = _checked(speed)
    jerk = np.diff(speed, 2) * rate_hz**2
    duration = len(speed) / rate_hz
    integral = float((jerk**2).sum()) / rate_hz
    if integral == 0.0:
        raise InputError("The smoothness of a movement at constant speed is not defined.")
    return -float(np.log(duration**3 / speed.max() ** 2 * integral))


def _checked(speed: np.ndarray) -> np.ndarray:
    speed = np.asarray(speed, dtype=float)
    if speed.ndim != 1 or len(speed) < 4 or not np.isfinite(speed).all() or speed.max() <= 0:
        raise InputError("Smoothness needs at least four samples of a speed that is not all zero.")
    return speed
