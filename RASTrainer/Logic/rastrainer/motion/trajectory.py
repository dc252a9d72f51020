"""The movement of a trial: samples of the tool, touches and contacts, and measures of its path.

All times are the trial's own, in s from its start, excluding pauses. Raw samples are resampled and
filtered before differentiation: 2 % of noise changes the log dimensionless jerk of a reach from
−5.3 to −15.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.fft import irfft, rfft, rfftfreq

from rastrainer.errors import InputError

NEAR_MM, FAR_MM = 20.0, 21.0
"""Clearances of the tip at which proximity starts and ends by default; the journal has the actual
settings."""
TOUCHING_MM, RELEASED_MM = 0.05, 0.3
"""Clearances of the tool at which contact starts and ends by default."""


@dataclass(frozen=True)
class Interval:
    """A time interval, the smallest signed distance of tool and head in it, and the largest depth
    of the commanded motion in the head."""

    start_s: float
    end_s: float
    least_clearance_mm: float = np.inf
    greatest_depth_mm: float = 0.0

    @property
    def duration_s(self) -> float:
        return self.end_s - self.start_s


@dataclass(frozen=True)
class Touch:
    """A touch: the fiducial due, the position of the tip (World, mm) and the time.

    A point of a trace is one without a label.
    """

    label: str
    position_mm: tuple[float, float, float]
    time_s: float


@dataclass(frozen=True, eq=False)
class Trajectory:
    """The movement of one trial.

    Attributes:
        times_s: (n,) float, strictly increasing.
        tip_mm: (n, 3) float, the tool's tip, World.
        clearance_mm: (n,) float, signed distance of the tool to the head.
        touches: kept touches, in order.
        traced: kept points of a trace, in order.
        near: intervals with the tip near the head, or the tool in contact.
        paused_s: their total duration.
        fiducials_mm: label → (3,) position in World; empty while secret.
        shortest_path_mm: the shortest free path through the task's fiducials, or None.
        depth_mm: (n,) float, how far the commanded motion went into the head beyond the tool; None
            unless recorded for the whole trial.
    """

    times_s: np.ndarray
    tip_mm: np.ndarray
    clearance_mm: np.ndarray
    touches: tuple[Touch, ...]
    refused: tuple[Touch, ...] = ()
    undone: int = 0
    near: tuple[Interval, ...] = ()
    contacts: tuple[Interval, ...] = ()
    camera_switches: int = 0
    pauses: int = 0
    paused_s: float = 0.0
    fiducials_mm: Mapping[str, np.ndarray] = field(default_factory=dict)
    shortest_path_mm: float | None = None
    depth_mm: np.ndarray | None = None
    traced: tuple[Touch, ...] = ()

    @property
    def intended(self) -> tuple[Touch, ...]:
        if not self.traced:
            return self.touches
        return tuple(sorted((*self.touches, *self.traced), key=lambda touch: touch.time_s))

    @property
    def touch_times_s(self) -> np.ndarray:
        """Times of the kept touches, (m,) float."""
        return np.array([touch.time_s for touch in self.touches])


INTENDED_MM = 5.0
"""Contact with the tip within this distance of a touch is intended."""


def unintended_contact(trajectory: Trajectory) -> tuple[float, float]:
    """Return the time (s) of unintended contact and the path (mm) of the tip during it.

    Contact is unintended while the tip is farther than `INTENDED_MM` from both the next and the
    previous kept touch or traced point; without any, always. The tip is interpolated linearly
    between samples. The midpoint between neighboring samples or touches decides, for the part of
    the time in contact. Repeated contact cannot lower the result.
    """
    contacts, samples_s = trajectory.contacts, trajectory.times_s
    if not contacts or not len(samples_s):
        return float(sum(contact.duration_s for contact in contacts)), 0.0
    # Before the first sample and after the last the tip is where that one has it.
    ends = [min(c.start_s for c in contacts), max(c.end_s for c in contacts)]
    outer = [time for time in ends if not samples_s[0] <= time <= samples_s[-1]]
    times = np.unique(np.concatenate([samples_s, trajectory.touch_times_s, outer]))
    tip = np.column_stack([np.interp(times, samples_s, axis) for axis in trajectory.tip_mm.T])
    starts, steps = times[:-1], np.diff(times)
    middle = (tip[:-1] + tip[1:]) / 2
    counts = _distance_to_touches(trajectory.intended, starts + steps / 2, middle) > INTENDED_MM
    in_contact = np.zeros(len(steps))
    for contact in contacts:
        in_contact += np.clip(contact.end_s, starts, times[1:]) - np.clip(
            contact.start_s, starts, times[1:]
        )
    speeds = np.linalg.norm(np.diff(tip, axis=0), axis=1) / steps
    time_s = in_contact * counts
    return float(time_s.sum()), float((time_s * speeds).sum())


def pressing_depth(trajectory: Trajectory) -> float | None:
    """Return how deep the tool was pressed into the head, mm; None if not recorded.

    sqrt(Σ kᵢ·dᵢ² / n) with dᵢ the greatest depth in contact i, kᵢ the number of kept touches in it,
    at least 1, and n the number of fiducials, or of kept touches while these are secret, and of
    the contacts in which something was traced. Further contacts can only add to the sum.
    """
    if trajectory.depth_mm is None:
        return None
    touch_times = trajectory.touch_times_s
    total = 0.0
    for contact in trajectory.contacts:
        touched = (contact.start_s <= touch_times) & (touch_times <= contact.end_s)
        total += max(1, int(touched.sum())) * contact.greatest_depth_mm**2
    count = len(trajectory.fiducials_mm) or len(touch_times)
    traced = [touch.time_s for touch in trajectory.traced]
    strokes = sum(any(c.start_s <= t <= c.end_s for t in traced) for c in trajectory.contacts)
    return float(np.sqrt(total / (count + strokes or 1)))


def _distance_to_touches(
    touches: Sequence[Touch], times: np.ndarray, tip: np.ndarray
) -> np.ndarray:
    """Return the tip's distance to the previous or next touch, the nearer one, (n,) float, mm."""
    places = np.array([touch.position_mm for touch in touches], dtype=float).reshape(-1, 3)
    if not len(places):
        return np.full(len(times), np.inf)
    following = np.searchsorted(np.array([touch.time_s for touch in touches]), times)
    neighbors = (np.maximum(following - 1, 0), np.minimum(following, len(places) - 1))
    return np.minimum(*(np.linalg.norm(tip - places[rows], axis=1) for rows in neighbors))


CUTOFF_HZ = 6.0
"""Voluntary hand movement lies below this; the default of `low_pass`."""


def resample(times_s: np.ndarray, values: np.ndarray, rate_hz: float) -> np.ndarray:
    """Return the values (n, k) at equal steps from the first time to the last, interpolated.

    The interpolation is linear, and the times, (n,) float, rise strictly.
    """
    times_s, values = np.asarray(times_s, dtype=float), np.asarray(values, dtype=float)
    if len(times_s) < 2 or not (np.diff(times_s) > 0).all():
        raise InputError("A trajectory needs at least two samples whose times rise.")
    count = int(np.floor((times_s[-1] - times_s[0]) * rate_hz + 1e-9)) + 1
    even = times_s[0] + np.arange(count) / rate_hz
    return np.column_stack([np.interp(even, times_s, column) for column in values.T])


def low_pass(values: np.ndarray, rate_hz: float, cutoff_hz: float = CUTOFF_HZ) -> np.ndarray:
    """Return evenly sampled values, (n, k) float, low-pass filtered without delay.

    A second-order Butterworth filter, run forward and backward, has the same gain 1/(1 + (f/fc)⁴)
    on the spectrum: at `cutoff_hz`, half the amplitude remains. The ends are extended by point
    reflection, which keeps straight lines straight.
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

    The positions, (n, 3) float with n ≥ 2, are evenly sampled and low-pass filtered.
    """
    return np.linalg.norm(np.gradient(positions_mm, 1 / rate_hz, axis=0), axis=1)


IDLE_SPEED_MM_S = 1.0
IDLE_DURATION_S = 0.3


def path_length(positions_mm: np.ndarray) -> float:
    """Return the length of the path through (n, 3) float positions, in mm.

    Resample and filter first: the noise of the samples would add up.
    """
    return float(np.linalg.norm(np.diff(positions_mm, axis=0), axis=1).sum())


def idle_time(speed_mm_s: np.ndarray, rate_hz: float) -> float:
    """Return the total time in s of rests: slower than 1 mm/s for longer than 0.3 s.

    The speed, (n,) float, is evenly sampled.
    """
    resting = np.concatenate([[False], np.asarray(speed_mm_s) < IDLE_SPEED_MM_S, [False]])
    changes = np.flatnonzero(np.diff(resting.astype(int)))
    durations = (changes[1::2] - changes[0::2]) / rate_hz
    return float(durations[durations > IDLE_DURATION_S].sum())


SPARC_CUTOFF_HZ = 10.0
SPARC_THRESHOLD = 0.05
SPARC_PAD_LEVEL = 4


def sparc(speed: np.ndarray, rate_hz: float) -> float:
    """Return the spectral arc length (Balasubramanian et al. 2015), dimensionless and below 0.

    The length of the curve of the speed's magnitude spectrum, scaled to 1 at its peak, up to the
    last frequency of at most 10 Hz where it reaches 0.05. The zero padding is theirs: four more
    powers of two. The speed, (n,) float, is of one movement, evenly sampled.
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

    A reach of minimum jerk has −ln 204.8 = −5.322. The speed, (n,) float, is of one movement,
    evenly sampled and low-pass filtered.
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
