"""Directions all over a sphere, for tests and measurements."""

import math

import numpy as np


def sphere_directions(count: int) -> np.ndarray:
    """Return `count` unit vectors spread evenly over the sphere (a Fibonacci spiral)."""
    index = np.arange(count) + 0.5
    z = 1.0 - 2.0 * index / count
    turn = math.pi * (1.0 + math.sqrt(5.0)) * index
    width = np.sqrt(1.0 - z * z)
    return np.column_stack([width * np.cos(turn), width * np.sin(turn), z])
