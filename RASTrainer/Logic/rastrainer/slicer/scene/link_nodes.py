"""The nodes that the link fills, made before the first message, and the texts of a peer in them."""

from __future__ import annotations

from typing import Any

from rastrainer.errors import InputError
from rastrainer.protocol import DeviceName
from rastrainer.slicer.scene.scene import ROLE_ATTRIBUTE, Role, findNode

ORIGINAL_NAME = "OriginalNodeName"
"""The attribute in which Slicer's connector keeps the name of the device that fills a node."""

TOUCH_COLOR = (0.95, 0.55, 0.1)


def prepareNodes(scene: Any) -> None:
    """Make the nodes that are missing; the connector adopts nodes of that name and class."""
    capturedPointsNode(scene)
    simStateNode(scene)
    tips = (DeviceName.TOOL_TIP_TO_WORLD, DeviceName.INSTRUMENT_TIP_TO_WORLD)
    for name in (*tips, *DeviceName.LINK_TO_WORLD):
        _node(scene, "vtkMRMLLinearTransformNode", name, name).SetSaveWithScene(False)


def capturedPointsNode(scene: Any) -> Any:
    """Return the list of touched points (World, mm), whatever users call it, or a new one."""
    className, role = "vtkMRMLMarkupsFiducialNode", Role.CAPTURED_POINTS
    node = findNode(scene, className, role)
    if node is None:
        node = _node(scene, className, role, DeviceName.CAPTURED_POINTS)
        node.SetLocked(True)
        node.CreateDefaultDisplayNodes()
        display = node.GetDisplayNode()
        display.SetSelectedColor(TOUCH_COLOR)
        display.SetGlyphScale(2.5)
        display.SetTextScale(3.5)
        display.SetOccludedVisibility(True)
    return node


def simStateNode(scene: Any) -> Any:
    """Return the text of the simulator's state, or a new one; it is never saved."""
    node = _node(scene, "vtkMRMLTextNode", Role.SIM_STATE, DeviceName.SIM_STATE)
    node.SetSaveWithScene(False)
    return node


def findIncomingNode(connector: Any, device: str) -> Any | None:
    """Return the node that the connector fills for a device, or None."""
    for index in range(connector.GetNumberOfIncomingMRMLNodes()):
        node = connector.GetIncomingMRMLNode(index)
        if node is not None and node.GetAttribute(ORIGINAL_NAME) == device:
            return node
    return None


def _node(scene: Any, className: str, role: str, name: str) -> Any:
    """Return the node of the role, else the one of the name, else a new one."""
    node = findNode(scene, className, role)
    if node is None:
        node = scene.GetFirstNode(name, className) or scene.AddNewNodeByClass(className, name)
        node.SetAttribute(ROLE_ATTRIBUTE, role)
    return node


def decodedText(text: str | bytes | None) -> str:
    """Return the text, empty where there is none.

    Raises:
        InputError: it is not UTF-8.
    """
    if isinstance(text, bytes):
        raise InputError("The text must be encoded in UTF-8.")
    return text or ""


def shownText(text: str | bytes | None) -> str:
    """Return a text to be shown, such as a label: what is not UTF-8 in it is replaced."""
    return text.decode("utf-8", "replace") if isinstance(text, bytes) else text or ""
