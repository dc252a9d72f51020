"""From where to look at a head, so that every one of its fiducials is seen."""

from __future__ import annotations

from itertools import combinations

import numpy as np

_AZIMUTHS = np.radians(np.arange(0.0, 360.0, 15.0))
_ELEVATIONS = np.radians([0.0, 25.0, 50.0])


def outwardDirections(points: np.ndarray, center: np.ndarray) -> np.ndarray:
    """Return (n, 3) unit vectors from the head's center through each point."""
    away = points - center
    return away / np.linalg.norm(away, axis=1, keepdims=True)


def chooseTwoViews(outward: np.ndarray) -> np.ndarray:
    """Return (2, 3) unit vectors, from the head towards two cameras.

    Of all pairs in a grid, the one in which the point that is seen worst is seen best; among
    equals, the one that shows the points best on the whole.

    Args:
        outward: (n, 3) float, unit vectors along which the points face.
    """
    grid = np.array(
        [
            (np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e))
            for e in _ELEVATIONS
            for a in _AZIMUTHS
        ]
    )
    facing = grid @ outward.T
    best = max(
        combinations(range(len(grid)), 2),
        key=lambda pair: _worth(np.maximum(facing[pair[0]], facing[pair[1]])),
    )
    return grid[list(best)]


def _worth(facing: np.ndarray) -> tuple[float, float]:
    return round(float(facing.min()), 2), float(facing.sum())
