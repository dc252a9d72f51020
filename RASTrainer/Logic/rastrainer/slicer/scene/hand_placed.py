"""The point lists that somebody has placed by hand as the tasks of a scenario."""

from __future__ import annotations

from typing import Any

from rastrainer.errors import InputError
from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.scenario.tasks import touch_order
from rastrainer.slicer.scene.control_points import labelsOf
from rastrainer.slicer.scene.scene import ROLE_ATTRIBUTE, nodesOfClass
from rastrainer.slicer.translation import _

MOST_LISTS = 6


def handPlacedLists(scene: Any, targets: Any) -> tuple[list[Any], list[str]]:
    """Return the lists that are taken, in the scene's order, and why others are left out.

    Args:
        scene: the scene.
        targets: the list of the planned targets, which are no fiducials; None where there is none.

    Raises:
        InputError: there is no list of fifteen fiducials, or the labels of one are no order.
    """
    taken: list[Any] = []
    leftOut = []
    for node in nodesOfClass(scene, "vtkMRMLMarkupsFiducialNode"):
        if node is targets or node.GetAttribute(ROLE_ATTRIBUTE) is not None:
            continue
        count = node.GetNumberOfDefinedControlPoints()
        if count != FIDUCIAL_COUNT or count != node.GetNumberOfControlPoints():
            told = _("The point list {name} is left out: it has {count} placed points, not {all}.")
            leftOut.append(told.format(name=node.GetName(), count=count, all=FIDUCIAL_COUNT))
        elif len(taken) == MOST_LISTS:
            told = _("The point list {name} is left out: a scenario has at most {most} tasks.")
            leftOut.append(told.format(name=node.GetName(), most=MOST_LISTS))
        else:
            taken.append(_checked(node))
    if not taken:
        told = _("There is no point list of {count} fiducials in the scene.")
        raise InputError(" ".join([told.format(count=FIDUCIAL_COUNT), *leftOut]))
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
