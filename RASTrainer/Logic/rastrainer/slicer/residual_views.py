"""From where to look at a head, so that every one of its fiducials is seen, and how near."""

from __future__ import annotations

from dataclasses import dataclass
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


@dataclass(frozen=True)
class Screen:
    """How a view maps RAS mm to pixels, counted from its middle.

    Attributes:
        axes: (2, 3) float, unit vectors to the right and up.
        focus: (3,) float, what is in the middle.
        pixelsPerMm: how near it is looked at.
    """

    axes: np.ndarray
    focus: np.ndarray
    pixelsPerMm: float

    def project(self, points: np.ndarray) -> np.ndarray:
        """Return (n, 2) pixels of (n, 3) points."""
        return self.pixelsPerMm * (points - self.focus) @ self.axes.T


def fitScreen(
    shown: np.ndarray, center: np.ndarray, direction: np.ndarray, width: float, height: float
) -> Screen:
    """Return the view, upright along S, in which points just fill `width` × `height` pixels.

    Args:
        shown: (n, 3) float, the points.
        center: (3,) float, a point in the depth that is in focus.
        direction: (3,) float, unit vector towards the camera, not along S.
        width: pixels.
        height: pixels.
    """
    right = np.cross([0.0, 0.0, 1.0], direction)
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(direction, right)])
    across = (shown - center) @ axes.T
    low, high = across.min(axis=0), across.max(axis=0)
    pixelsPerMm = float(min(np.array([width, height]) / (high - low)))
    return Screen(axes, center + 0.5 * (low + high) @ axes, pixelsPerMm)
