"""A row of capsules that covers a tapered tool along its axis."""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from rastrainer.errors import InputError
from rastrainer_simulator.collision.capsules import Capsule

_SLICE = 0.0005


def capsules_along(points: np.ndarray, start: float, count: int = 5) -> tuple[Capsule, ...]:
    """Return a row of capsules about the z axis that hold all `points` (k, 3) float with z ≥ start.

    The tool's tip is at the origin: of all ways to cut the tool into `count` pieces, the one is
    taken whose pieces look slenderest from there, so that a taper stays a taper. `points` are
    `surface_points` spaced by at most half a millimetre.

    Raises:
        InputError: no point is that far up the axis.
    """
    if points[:, 2].max() < start:
        raise InputError("The tool's collision mesh should reach from its tip toward the wrist.")
    profile = _profile(points, start)
    cuts = _slenderest_cuts(profile, start, min(count, len(profile)))
    return tuple(
        _section(profile[first:last], start + first * _SLICE) for first, last in pairwise(cuts)
    )


def _profile(points: np.ndarray, start: float) -> np.ndarray:
    """Return the radius of each slice of half a millimetre, from z = start on."""
    slices = np.floor((points[:, 2] - start) / _SLICE).astype(int)
    kept = slices >= 0
    radii = np.zeros(slices.max() + 1)
    np.maximum.at(radii, slices[kept], np.hypot(points[kept, 0], points[kept, 1]))
    # What touches the border of two slices belongs to both.
    return np.maximum(radii, np.concatenate([radii[1:], [0.0]]))


def _slenderest_cuts(profile: np.ndarray, start: float, count: int) -> list[int]:
    """Return where to cut (count + 1 slices) for the least sum of radius² / z² over all slices.

    Dynamic programming: the best cuts before a slice, for each number of pieces so far.
    """
    size = len(profile)
    weights = np.cumsum(1.0 / (start + np.arange(size + 1) * _SLICE) ** 2)
    least = np.full((count + 1, size + 1), np.inf)
    least[0, 0] = 0.0
    before = np.zeros((count + 1, size + 1), dtype=int)
    for end in range(1, size + 1):
        radii = np.maximum.accumulate(profile[:end][::-1])[::-1]
        totals = least[:-1, :end] + radii**2 * (weights[end] - weights[:end])
        before[1:, end] = totals.argmin(axis=1)
        least[1:, end] = totals.min(axis=1)
    cuts = [size]
    for pieces in range(count, 0, -1):
        cuts.append(int(before[pieces, cuts[-1]]))
    return cuts[::-1]


def _section(profile: np.ndarray, start: float) -> Capsule:
    """Return the capsule about the slices of a section: its round ends stick out only as needed."""
    radius = float(profile.max())
    low = start + np.arange(len(profile)) * _SLICE
    rounding = np.sqrt(radius**2 - profile**2)
    first = float((low + rounding).min())
    last = max(float((low + _SLICE - rounding).max()), first)
    return Capsule(np.array([0.0, 0.0, first]), np.array([0.0, 0.0, last]), radius)
