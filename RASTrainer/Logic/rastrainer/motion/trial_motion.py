"""The motion metrics of a trial, by name, from its trajectory.

`rastrainer.study.outcomes` defines each metric with its unit, thresholds and source. The same
function is used when a trial is registered, when its journal is read, and when it is replayed:
equal samples give equal numbers. None is shown during a trial, because the low-pass filter also
runs backward from the end, so values of a part would change later.

Throughput is a variant of ISO 9241-411. ISO takes the effective width from the standard deviation
of the end points about their own mean, so a constant offset leaves it near 0 and the throughput
unbounded. Here the width is the root mean square distance from the targets; both agree for unbiased
touches. Among the choices that the standard leaves open: one-dimensional, along the line between
the targets; the distance actually traveled along it; the mean over the movements of difficulty over
time, not mean difficulty over mean time.
"""

from __future__ import annotations

import contextlib
import math
from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.motion.trajectory import (
    Interval,
    Touch,
    Trajectory,
    idle_time,
    log_dimensionless_jerk,
    low_pass,
    path_length,
    pressing_depth,
    resample,
    sparc,
    speeds,
    unintended_contact,
)

WIDTH_FACTOR = 4.133
"""√(2πe): the width that holds 96 % of end points that scatter normally about the target."""


@dataclass(frozen=True)
class Throughput:
    """Speed and accuracy of pointing in one number: mean of effective index of difficulty over
    movement time.

    Both are measured along the task axes: the effective width, 4.133·RMS distance of the end points
    from their targets, and the effective distance of each movement.
    """

    bits_per_s: float
    effective_width_mm: float
    effective_distances_mm: tuple[float, ...]


def effective_throughput(
    targets_mm: np.ndarray, touches_mm: np.ndarray, touch_times_s: np.ndarray
) -> Throughput:
    """Return the throughput of the n − 1 movements between n touches.

    The task axis of a movement runs from its first target to its second. The distance is measured
    from where the movement really began. Targets and touches are (n, 3) float in one frame; the
    times, (n,) float, rise strictly.
    """
    targets, touches = np.asarray(targets_mm, dtype=float), np.asarray(touches_mm, dtype=float)
    durations = np.diff(np.asarray(touch_times_s, dtype=float))
    if len(targets) < 4 or targets.shape != touches.shape or len(durations) != len(targets) - 1:
        raise InputError("Throughput needs at least four touches, each with its target and time.")
    if not (durations > 0).all():
        raise InputError("Throughput needs touches whose times rise.")
    steps = np.diff(targets, axis=0)
    lengths = np.linalg.norm(steps, axis=1, keepdims=True)
    if not (lengths > 0).all():
        raise InputError("Throughput needs neighboring targets at different places.")
    axes = steps / lengths
    deviations = ((touches - targets)[1:] * axes).sum(axis=1)
    width = WIDTH_FACTOR * float(np.sqrt(np.mean(deviations**2)))
    if not width > 0:
        raise InputError("Throughput needs touches that are not exactly on their targets.")
    distances = (np.diff(touches, axis=0) * axes).sum(axis=1)
    difficulties = np.log2(np.maximum(distances, 0.0) / width + 1)
    return Throughput(
        bits_per_s=float(np.mean(difficulties / durations)),
        effective_width_mm=width,
        effective_distances_mm=tuple(map(float, distances)),
    )


RATE_HZ = 50.0
"""Sampling rate after resampling; the journal has the same."""
DWELL_RADIUS_MM = 2.0
ACCEPTANCE_MM = 10.0
"""A refused touch within this distance of another fiducial was of the wrong one; a contact that
starts within this distance of a touch belongs to it."""
MIN_MOVEMENT_SAMPLES = 10
"""Shorter movements (0.2 s) have no meaningful smoothness."""


def trial_motion(trajectory: Trajectory) -> dict[str, float]:
    """Return the metrics that the trajectory of a whole or partial trial allows."""
    metrics = _counts(trajectory)
    if len(trajectory.times_s) < 2:
        return metrics
    tip = low_pass(resample(trajectory.times_s, trajectory.tip_mm, RATE_HZ), RATE_HZ)
    times = trajectory.times_s[0] + np.arange(len(tip)) / RATE_HZ
    speed = speeds(tip, RATE_HZ) if len(tip) > 1 else np.zeros(len(tip))
    metrics |= {
        "path_length_mm": path_length(tip),
        "mean_speed_mm_s": float(speed.mean()),
        "peak_speed_mm_s": float(speed.max()),
        "idle_time_s": idle_time(speed[times <= _end_s(trajectory)], RATE_HZ),
        "least_clearance_mm": float(trajectory.clearance_mm.min()),
    }
    if len(trajectory.touches) > 1:
        metrics |= _of_movements(trajectory, times, tip, speed)
        shortest_mm, actual_mm = trajectory.shortest_path_mm, metrics["path_between_touches_mm"]
        is_whole = 0 < len(trajectory.fiducials_mm) == len(trajectory.touches)
        if is_whole and shortest_mm is not None and min(shortest_mm, actual_mm) > 0:
            metrics["path_efficiency"] = shortest_mm / actual_mm
        metrics |= _throughput(trajectory)
    return metrics


def _end_s(trajectory: Trajectory) -> float:
    """Return when the trainee's work ends: what follows the last point waits for the result."""
    return trajectory.intended[-1].time_s if trajectory.intended else math.inf


def _counts(trajectory: Trajectory) -> dict[str, float]:
    contacts = trajectory.contacts
    touch_times = trajectory.touch_times_s
    meant = [_is_meant(contact, trajectory) for contact in contacts]
    unintended_s, unintended_mm = unintended_contact(trajectory)
    depth_mm = pressing_depth(trajectory)
    metrics = {
        "proximity_time_s": sum(interval.duration_s for interval in trajectory.near),
        "contact_time_s": sum(contact.duration_s for contact in contacts),
        "contacts": len(contacts),
        "unintended_contacts": meant.count(False),
        "unintended_contact_time_s": unintended_s,
        "unintended_contact_path_mm": unintended_mm,
        "deepest_contact_mm": max([0.0, *(-c.least_clearance_mm for c in contacts)]),
        "refused_touches": len(trajectory.refused),
        "undone_touches": trajectory.undone,
        "camera_switches": trajectory.camera_switches,
        "pauses": trajectory.pauses,
        "pause_time_s": trajectory.paused_s,
    }
    if depth_mm is not None:
        metrics["pressing_depth_mm"] = depth_mm
    if len(touch_times):
        metrics["completion_time_s"] = _end_s(trajectory)
    if trajectory.fiducials_mm:
        metrics["wrong_order_touches"] = sum(
            _is_wrong(touch, trajectory) for touch in trajectory.refused
        )
    return {name: float(value) for name, value in metrics.items()}


def _is_meant(contact: Interval, trajectory: Trajectory) -> bool:
    """Return whether a contact started near the next or the previous touch or traced point."""
    if not len(trajectory.times_s):
        return False
    start = int(np.searchsorted(trajectory.times_s, contact.start_s))
    row = min(start, len(trajectory.times_s) - 1)
    touches = trajectory.intended
    following = int(np.searchsorted([touch.time_s for touch in touches], contact.start_s))
    neighbors = touches[max(following - 1, 0) : following + 1]
    distances = [float(np.linalg.norm(trajectory.tip_mm[row] - t.position_mm)) for t in neighbors]
    return min(distances, default=np.inf) <= ACCEPTANCE_MM


def _is_wrong(touch: Touch, trajectory: Trajectory) -> bool:
    distances = {
        label: float(np.linalg.norm(np.asarray(position) - touch.position_mm))
        for label, position in trajectory.fiducials_mm.items()
    }
    nearest = min(distances, key=distances.__getitem__)
    return nearest != touch.label and distances[nearest] <= ACCEPTANCE_MM


def _of_movements(
    trajectory: Trajectory, times: np.ndarray, tip: np.ndarray, speed: np.ndarray
) -> dict[str, float]:
    """Return the metrics of the movements from each touch to the next."""
    first = np.searchsorted(times, trajectory.touch_times_s[:-1])
    last = np.searchsorted(times, trajectory.touch_times_s[1:], side="right")
    parts = [slice(a, b) for a, b in zip(first, last, strict=True) if b - a >= MIN_MOVEMENT_SAMPLES]
    found: dict[str, list[float]] = {"sparc": [], "ldlj": [], "time_to_peak_speed": []}
    for part in parts:
        with contextlib.suppress(InputError):
            found["sparc"].append(sparc(speed[part], RATE_HZ))
            found["ldlj"].append(log_dimensionless_jerk(speed[part], RATE_HZ))
        found["time_to_peak_speed"].append(float(np.argmax(speed[part])) / len(speed[part]))
    metrics = {name: float(np.median(values)) for name, values in found.items() if values}
    metrics["movement_time_s"] = float(np.median(np.diff(trajectory.touch_times_s)))
    dwells = [_dwell(touch, times, tip) for touch in trajectory.touches]
    metrics["dwell_before_touch_s"] = float(np.median(dwells))
    metrics["path_between_touches_mm"] = path_length(tip[first[0] : last[-1]])
    return metrics


def _dwell(touch: Touch, times: np.ndarray, tip: np.ndarray) -> float:
    """Return how long the tip had been near the point when it was touched, in s."""
    until = int(np.searchsorted(times, touch.time_s, side="right"))
    is_far = np.linalg.norm(tip[:until] - touch.position_mm, axis=1) > DWELL_RADIUS_MM
    left = np.flatnonzero(is_far)
    return (until - 1 - int(left[-1]) if len(left) else until) / RATE_HZ


def _throughput(trajectory: Trajectory) -> dict[str, float]:
    labels = [touch.label for touch in trajectory.touches]
    if not all(label in trajectory.fiducials_mm for label in labels):
        return {}
    fiducials = np.array([trajectory.fiducials_mm[label] for label in labels])
    with contextlib.suppress(InputError):
        touched = np.array([touch.position_mm for touch in trajectory.touches])
        result = effective_throughput(fiducials, touched, trajectory.touch_times_s)
        return {
            "throughput_bit_s": result.bits_per_s,
            "effective_width_mm": result.effective_width_mm,
        }
    return {}
