"""Fitts' throughput of the touches: a variant of ISO 9241-411 that a constant offset lowers.

ISO takes the effective width from the standard deviation of the end points about their own mean.
Who misses every target by the same amount then has a width of nearly 0 and a throughput without
bound. Here the width is taken from the root mean square distance from the targets themselves; where
touches are right on average both agree. Further choices, of those that the standard leaves open:
one-dimensional, along the line between the targets; the distance really traveled along it; the mean
over the movements of difficulty over time, not the mean difficulty over the mean time.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError

WIDTH_FACTOR = 4.133
"""√(2πe): the width that holds 96 % of end points that scatter normally about the target."""


@dataclass(frozen=True)
class Throughput:
    """Speed and accuracy of pointing in one number.

    Attributes:
        bits_per_s: Mean of effective index of difficulty over movement time.
        effective_width_mm: We = 4.133·RMS distance of the end points from their targets, along
            the task axes.
        effective_distances_mm: De of each movement, along its task axis.
        difficulties_bits: IDe = log₂(De/We + 1) of each movement.
    """

    bits_per_s: float
    effective_width_mm: float
    effective_distances_mm: tuple[float, ...]
    difficulties_bits: tuple[float, ...]


def effective_throughput(
    targets_mm: np.ndarray, touches_mm: np.ndarray, touch_times_s: np.ndarray
) -> Throughput:
    """Return the throughput of the n − 1 movements between n touches.

    The task axis of a movement runs from its first target to its second. The distance is measured
    from where the movement really began.

    Args:
        targets_mm: (n, 3) float, the fiducials.
        touches_mm: (n, 3) float, the touches, in the targets' frame.
        touch_times_s: (n,) float, strictly rising.

    Raises:
        InputError: fewer than four touches, counts that differ, times that do not rise, equal
            neighboring targets, or end points that are all exactly on their targets.
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
        difficulties_bits=tuple(map(float, difficulties)),
    )
