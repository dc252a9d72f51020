"""The nodes that the link fills: made before the first message, so that they look as we want."""

from __future__ import annotations

from typing import Any

from rastrainer.protocol import Device
from rastrainer.slicer.scene import ROLE_ATTRIBUTE, Role

TOUCH_COLOR = (0.95, 0.55, 0.1)


def capturedPointsNode(scene: Any) -> Any:
    """Return the list of touched points (World, mm); made where it is missing."""
    node = _named(scene, "vtkMRMLMarkupsFiducialNode", Device.CAPTURED_POINTS)
    if node.GetAttribute(ROLE_ATTRIBUTE) != Role.CAPTURED_POINTS:
        node.SetAttribute(ROLE_ATTRIBUTE, Role.CAPTURED_POINTS)
        node.SetLocked(True)
        node.CreateDefaultDisplayNodes()
        display = node.GetDisplayNode()
        display.SetSelectedColor(TOUCH_COLOR)
        display.SetGlyphScale(2.5)
        display.SetTextScale(3.5)
        display.SetOccludedVisibility(True)
    return node


def simStateNode(scene: Any) -> Any:
    """Return the text of the simulator's state; made where it is missing, never saved."""
    node = _named(scene, "vtkMRMLTextNode", Device.SIM_STATE)
    node.SetSaveWithScene(False)
    return node


def poseNodes(scene: Any) -> tuple[Any, ...]:
    """Return the transforms of tool tip and robot links to World; made where missing, not saved."""
    names = (Device.TOOL_TIP_TO_WORLD, *Device.LINK_TO_WORLD)
    nodes = tuple(_named(scene, "vtkMRMLLinearTransformNode", name) for name in names)
    for node in nodes:
        node.SetSaveWithScene(False)
    return nodes


def prepareNodes(scene: Any) -> None:
    """Make the nodes that are missing; the connector adopts nodes of that name and class."""
    for makeNode in (capturedPointsNode, simStateNode, poseNodes):
        makeNode(scene)


def findIncomingNode(connector: Any, name: str) -> Any | None:
    """Return the node that the connector has filled for the device, or None."""
    for index in range(connector.GetNumberOfIncomingMRMLNodes()):
        node = connector.GetIncomingMRMLNode(index)
        if node is not None and node.GetName() == name:
            return node
    return None


def _named(scene: Any, className: str, name: str) -> Any:
    return scene.GetFirstNode(name, className) or scene.AddNewNodeByClass(className, name)
