"""Where labels stand beside their points, so that they hide neither each other nor the points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

Side = tuple[int, int]

SIDES: tuple[Side, ...] = ((1, 1), (1, -1), (-1, 1), (-1, -1), (1, 0), (-1, 0), (0, 1), (0, -1))
"""To the right and up is the favorite; each number is −1, 0 or 1 along right and up."""

_COST_OF_OVERLAP = 10.0


def placeLabels(
    anchors: np.ndarray, sizes: np.ndarray, obstacles: np.ndarray, gap: float
) -> Sequence[Side]:
    """Return on which side of its anchor each label stands.

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
