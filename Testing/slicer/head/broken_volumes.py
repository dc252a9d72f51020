"""Volumes that are broken or not heads, each with a part of the error that refuses it."""

from __future__ import annotations

import numpy as np

from rastrainer.slicer.head.volume import Volume


def block(shape=(100, 100, 100), spacing=(1.5, 1.5, 1.5), fill=None):
    """Return a volume with a block of tissue in its middle, or with one value throughout."""
    values = np.zeros(shape, np.float32)
    if fill is None:
        values[tuple(slice(n // 4, 3 * n // 4) for n in shape)] = 100.0
    else:
        values += fill
    return Volume(values, np.diag([*spacing, 1.0]))


def with_nan():
    broken = block()
    broken.values[3, 4, 5] = np.nan
    return broken


def noise():
    values = np.random.default_rng(1).uniform(0, 100, (60, 60, 60)).astype(np.float32)
    return Volume(values, np.diag([1.6, 1.6, 1.6, 1.0]))


UNUSABLE = {
    "empty": (block(fill=0.0), "The volume is empty"),
    "2D": (block((200, 200, 1)), "needs a 3D volume"),
    "NaN": (with_nan(), "not numbers"),
    "meters": (block(spacing=(0.0015,) * 3), "not in millimeters"),
    "micrometers": (block(spacing=(1500.0,) * 3), "not in millimeters"),
    "9 mm slices": (block(spacing=(1.0, 1.0, 9.0)), "9.0 mm apart"),
}
HEADLESS = {
    "noise": (noise(), "No head was found"),
    "a block": (block(spacing=(1.2, 1.2, 1.2)), "No head was found"),
}
