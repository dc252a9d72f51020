"""The WorldToHead transform: planned, or registered from two lists of points in the scene."""

from __future__ import annotations

from typing import Any

import numpy as np
import slicer

from rastrainer import transforms
from rastrainer.files.point_list import PointList, pair
from rastrainer.registration.fits import RIGID
from rastrainer.registration.registration import Registration, register
from rastrainer.scenario.scenario import Scenario
from rastrainer.slicer.scene.control_points import labelsOf, localPoints, worldPoints
from rastrainer.slicer.scene.robot_scene import placeRobot
from rastrainer.slicer.scene.scene import Role, findNode, findOrAddNode

MOVING_REFERENCE = "RASTrainer.moving"
FIXED_REFERENCE = "RASTrainer.fixed"
KIND_ATTRIBUTE = "RASTrainer.registration"
FRE_ATTRIBUTE = "RASTrainer.freMm"


def registerNodes(moving: Any, fixed: Any, kind: str = RIGID) -> Registration:
    """Register the points of one `vtkMRMLMarkupsNode` to those of another, paired by label.

    The moving points are taken in their own frame, so that it does not matter whether an earlier
    result is applied to them; the fixed points are taken where Slicer shows them.

    Raises:
        InputError: the lists do not pair up, or the points cannot be registered.
    """
    labels, movingPoints, fixedPoints = pair(
        PointList(labelsOf(moving), localPoints(moving)),
        PointList(labelsOf(fixed), worldPoints(fixed)),
    )
    return register(movingPoints, fixedPoints, kind, labels)


def showRegistration(scene: Any, registration: Registration, moving: Any, fixed: Any) -> Any:
    """Put a registration into the scene's WorldToHead transform and return that node.

    The node remembers its lists of points. Whether it is applied to the moving points stays as it
    was; the first time it is.
    """
    node = findOrAddNode(scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD, "WorldToHead")
    isFirst = movingNode(node) is None
    node.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(registration.matrix))
    rememberLists(node, moving, fixed)
    node.SetAttribute(KIND_ATTRIBUTE, registration.kind)
    node.SetAttribute(FRE_ATTRIBUTE, f"{registration.fre_mm:.6f}")
    if isFirst:
        setApplied(node, True)
    return node


def rememberLists(transformNode: Any, moving: Any, fixed: Any) -> None:
    """Store in the transform which lists of points it was computed from."""
    transformNode.SetNodeReferenceID(MOVING_REFERENCE, moving.GetID())
    transformNode.SetNodeReferenceID(FIXED_REFERENCE, fixed.GetID())


def movingNode(transformNode: Any) -> Any | None:
    """Return the list of touched points that the transform was made from, if it still exists."""
    return transformNode.GetNodeReference(MOVING_REFERENCE)


def isApplied(transformNode: Any) -> bool:
    """Return whether the touched points are shown on the head."""
    moving = movingNode(transformNode)
    return moving is not None and moving.GetTransformNodeID() == transformNode.GetID()


def setApplied(transformNode: Any, applied: bool) -> None:
    """Show the touched points on the head, or where they are in the robot's World."""
    moving = movingNode(transformNode)
    if moving is not None:
        moving.SetAndObserveTransformNodeID(transformNode.GetID() if applied else None)
        if moving.GetDisplayNode() is not None:
            # On the head, the fiducials beside them have the same numbers.
            moving.GetDisplayNode().SetPointLabelsVisibility(not applied)


def matrixOf(transformNode: Any) -> np.ndarray:
    """Return the transform to the parent, (4, 4) float, mm."""
    return slicer.util.arrayFromTransformMatrix(transformNode)


PLANNED = "planned"


def showPlannedPlace(scene: Any, scenario: Scenario, moving: Any, fixed: Any) -> Any:
    """Place World as the scenario plans it, and return the WorldToHead transform.

    The head of a trial is placed a little differently; only its registration shows where.
    """
    known = findNode(scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD)
    wasApplied = known is None or isApplied(known)
    node = findOrAddNode(scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD, "WorldToHead")
    matrix = transforms.inverse(scenario.head_to_world)
    node.SetMatrixTransformToParent(slicer.util.vtkMatrixFromArray(matrix))
    node.SetAttribute(KIND_ATTRIBUTE, PLANNED)
    node.RemoveAttribute(FRE_ATTRIBUTE)
    rememberLists(node, moving, fixed)
    setApplied(node, wasApplied)
    return node


def isPlanned(transform: Any) -> bool:
    """Return whether the transform is the planned pose rather than a registration."""
    return transform.GetAttribute(KIND_ATTRIBUTE) == PLANNED


def followPlacement(scene: Any) -> None:
    """Show the robot where the touched points are shown: at the head, or in World."""
    node = findNode(scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD)
    placeRobot(scene, node if node is not None and isApplied(node) else None)
