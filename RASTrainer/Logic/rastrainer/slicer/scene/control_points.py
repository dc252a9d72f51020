"""Reads and writes the control points of markups nodes as arrays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import slicer

from rastrainer.slicer.scene.link_nodes import shownText


def labelsOf(node: Any) -> tuple[str, ...]:
    """Return the labels of a `vtkMRMLMarkupsNode`."""
    return tuple(labelOf(node, i) for i in range(node.GetNumberOfControlPoints()))


def labelOf(node: Any, index: int) -> str:
    """Return the label of one point; a peer may have given it one that is no text."""
    return shownText(node.GetNthControlPointLabel(index))


def localPoints(node: Any) -> np.ndarray:
    """Return the points as they were received or placed, (n, 3) float, mm, in the node's frame."""
    return slicer.util.arrayFromMarkupsControlPoints(node)


def worldPoints(node: Any) -> np.ndarray:
    """Return the points where Slicer shows them, (n, 3) float, RAS mm."""
    return slicer.util.arrayFromMarkupsControlPoints(node, world=True)


def setPoints(node: Any, labels: Sequence[str], points: np.ndarray) -> None:
    """Replace the points of a `vtkMRMLMarkupsNode`.

    Args:
        node: the node.
        labels: one for each point.
        points: (n, 3) float, mm, in the node's own frame.
    """
    wasModifying = node.StartModify()
    node.RemoveAllControlPoints()
    slicer.util.updateMarkupsControlPointsFromArray(node, np.asarray(points, dtype=float))
    for index, label in enumerate(labels):
        node.SetNthControlPointLabel(index, label)
    node.EndModify(wasModifying)
