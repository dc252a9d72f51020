"""Control points of markups as arrays, and the lists that a user placed as tasks."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import slicer

from rastrainer.errors import InputError
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.scenario.points import touch_order
from rastrainer.slicer.scene.link_nodes import shownText
from rastrainer.slicer.scene.scene import ROLE_ATTRIBUTE, nodesOfClass
from rastrainer.slicer.translation import _


def labelsOf(node: Any) -> tuple[str, ...]:
    """Return the labels of a `vtkMRMLMarkupsNode`."""
    return tuple(labelOf(node, i) for i in range(node.GetNumberOfControlPoints()))


def labelOf(node: Any, index: int) -> str:
    """Return the label of one point; a peer may have sent one that is not UTF-8."""
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


MAX_LISTS = 6


def handPlacedLists(scene: Any, targets: Any) -> tuple[list[Any], list[str]]:
    """Return the usable lists, in the scene's order, and why others are left out.

    Args:
        scene: the scene.
        targets: the list of the planned targets, which are no fiducials; None where there is none.

    Raises:
        InputError: there is no list of fifteen fiducials, or its labels give no order.
    """
    taken: list[Any] = []
    leftOut = []
    for node in nodesOfClass(scene, "vtkMRMLMarkupsFiducialNode"):
        if node is targets or node.GetAttribute(ROLE_ATTRIBUTE) is not None:
            continue
        count = node.GetNumberOfDefinedControlPoints()
        if count != FIDUCIAL_COUNT or count != node.GetNumberOfControlPoints():
            reason = _(
                "The point list {name} is left out: it has {count} placed points, not {all}."
            )
            leftOut.append(reason.format(name=node.GetName(), count=count, all=FIDUCIAL_COUNT))
        elif len(taken) == MAX_LISTS:
            reason = _("The point list {name} is left out: a scenario has at most {most} tasks.")
            leftOut.append(reason.format(name=node.GetName(), most=MAX_LISTS))
        else:
            taken.append(_checked(node))
    if not taken:
        problem = _("There is no point list of {count} fiducials in the scene.")
        raise InputError(" ".join([problem.format(count=FIDUCIAL_COUNT), *leftOut]))
    return taken, leftOut


def _checked(node: Any) -> Any:
    try:
        touch_order(labelsOf(node))
    except InputError as error:
        raise InputError(
            _("The point list {name} cannot be used: {reason}").format(
                name=node.GetName(), reason=error
            )
        ) from None
    return node
