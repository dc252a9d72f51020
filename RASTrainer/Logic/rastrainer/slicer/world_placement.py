"""Where the robot's World stands in the scene: as planned, until touches tell it better."""

from __future__ import annotations

from typing import Any

import slicer

from rastrainer import transforms
from rastrainer.scenario import Scenario
from rastrainer.slicer.registration_nodes import (
    FRE_ATTRIBUTE,
    KIND_ATTRIBUTE,
    isApplied,
    rememberLists,
    setApplied,
)
from rastrainer.slicer.robot_scene import placeRobot
from rastrainer.slicer.scene import Role, findNode, findOrAddNode

PLANNED = "planned"


def showPlannedPlace(scene: Any, scenario: Scenario, moving: Any, fixed: Any) -> Any:
    """Put World where the scenario plans it, and return the WorldToHead transform.

    A trial's head stands a little elsewhere, which only its registration tells.
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
    """Tell whether the transform is the planned place, and no registration."""
    return transform.GetAttribute(KIND_ATTRIBUTE) == PLANNED


def followPlacement(scene: Any) -> None:
    """Let the robot stand where the touched points are shown: on the head, or in World."""
    node = findNode(scene, "vtkMRMLLinearTransformNode", Role.WORLD_TO_HEAD)
    placeRobot(scene, node if node is not None and isApplied(node) else None)
