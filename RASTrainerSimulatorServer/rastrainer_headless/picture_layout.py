"""From where a picture shows a head, and where the labels of its points are."""

from __future__ import annotations

from collections.abc import Sequence
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
class ViewPlane:
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
) -> ViewPlane:
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
    return ViewPlane(axes, center + 0.5 * (low + high) @ axes, pixelsPerMm)


Side = tuple[int, int]

SIDES: tuple[Side, ...] = ((1, 1), (1, -1), (-1, 1), (-1, -1), (1, 0), (-1, 0), (0, 1), (0, -1))
"""To the right and up is the favorite; each number is −1, 0 or 1 along right and up."""

_COST_OF_OVERLAP = 10.0


def placeLabels(
    anchors: np.ndarray, sizes: np.ndarray, obstacles: np.ndarray, gap: float
) -> Sequence[Side]:
    """Return on which side of its anchor each label is.

    The labels are placed one after the other, each where it covers the least.

    Args:
        anchors: (n, 2) float, pixels, to the right and up.
        sizes: (n, 2) float, width and height of the labels, pixels.
        obstacles: (m, 2) float, places that should stay free, pixels.
        gap: pixels between an anchor and its label.
    """
    placed: list[np.ndarray] = []
    sides: list[Side] = []
    for anchor, size in zip(anchors, sizes, strict=True):
        boxes = [_box(anchor, size, side, gap) for side in SIDES]
        costs = [_cost(box, placed, obstacles) for box in boxes]
        best = int(np.argmin(costs))
        placed.append(boxes[best])
        sides.append(SIDES[best])
    return sides


def _box(anchor: np.ndarray, size: np.ndarray, side: Side, gap: float) -> np.ndarray:
    """Return the lower left and the upper right corner of a label, (2, 2) float."""
    direction = np.array(side)
    lower = anchor + gap * direction + np.choose(direction + 1, [-size, -0.5 * size, 0.0 * size])
    return np.array([lower, lower + size])


def _cost(box: np.ndarray, placed: Sequence[np.ndarray], obstacles: np.ndarray) -> float:
    lower, upper = box
    overlaps = [
        np.prod(np.clip(np.minimum(upper, other[1]) - np.maximum(lower, other[0]), 0.0, None))
        for other in placed
    ]
    covered = np.all((obstacles > lower) & (obstacles < upper), axis=1).sum()
    return _COST_OF_OVERLAP * float(sum(overlaps)) / float(np.prod(upper - lower)) + float(covered)
