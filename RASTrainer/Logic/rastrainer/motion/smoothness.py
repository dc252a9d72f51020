"""Smoothness of a movement, from its speed profile; values nearer to 0 are smoother."""

from __future__ import annotations

import numpy as np
from numpy.fft import rfft, rfftfreq

from rastrainer.errors import InputError

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
