"""Our nodes in the scene: found or made, their content, their points, and the link's nodes."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import slicer

from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList
from rastrainer.protocol import DeviceName

MODEL, SEGMENTATION = "vtkMRMLModelNode", "vtkMRMLSegmentationNode"
VOLUME, TABLE = "vtkMRMLScalarVolumeNode", "vtkMRMLTableNode"
LIST, LINE = "vtkMRMLMarkupsFiducialNode", "vtkMRMLMarkupsLineNode"
TRANSFORM, TEXT = "vtkMRMLLinearTransformNode", "vtkMRMLTextNode"

ROLE_ATTRIBUTE = "RASTrainer.role"


class Role:
    """The purpose of one of our nodes; it survives renaming, saving and loading."""

    HEAD_MODEL = "head model"
    HEAD_PREVIEW = "head preview"
    HEAD_SEGMENT = "head segment"
    HEAD_VOLUME = "head volume"
    SKULL = "skull"
    FIXED_FIDUCIALS = "fixed fiducials"
    TARGET = "target"
    TRAJECTORY = "trajectory"
    CAPTURED_POINTS = "captured points"
    SIM_STATE = "simulator state"
    WORLD_TO_HEAD = "world to head"
    RESIDUALS = "residuals"
    RESIDUAL_ARROWS = "residual arrows"
    FITS = "fits"
    HISTORY = "history"
    LEARNING_CURVE = "learning curve"
    CALIBRATION = "calibration"
    SCORE = "score"
    COMPARISON = "comparison"
    MOTION = "motion metrics"
    PLAN_TARGET = "plan target"
    PLAN_TRAJECTORY = "plan trajectory"
    PLAN_LINE = "procedure plan line"
    NO_GO = "procedure no-go structure"
    CHECKPOINTS = "procedure checkpoints"
    PLANNED_LINE = "procedure planned line"
    REGISTERED_LINE = "procedure registered line"
    TRUE_LINE = "procedure true line"
    ERRORS_BY_REGISTRATION = "procedure errors by registration"
    ERRORS_BY_HAND = "procedure errors by hand"
    PROCEDURE_ERRORS = "procedure errors"
    ROBOT = "robot"
    REPLAY = "replay"
    LANDMARKS = "landmarks"
    TRACED_POINTS = "traced points"
    NEXT_PLACE = "next place of the trace"


def findNode(scene: Any, className: str, role: str) -> Any | None:
    return next(iter(nodesOf(scene, className, role)), None)


def nodesOf(scene: Any, className: str, role: str) -> list[Any]:
    nodes = nodesOfClass(scene, className)
    return [node for node in nodes if node.GetAttribute(ROLE_ATTRIBUTE) == role]


def nodesOfClass(scene: Any, className: str) -> list[Any]:
    """Return all nodes of the class or of classes derived from it, in the scene's order."""
    nodes = scene.GetNodesByClass(className)
    nodes.UnRegister(None)
    return [nodes.GetItemAsObject(index) for index in range(nodes.GetNumberOfItems())]


def removeNode(scene: Any, className: str, role: str) -> None:
    node = findNode(scene, className, role)
    if node is not None:
        scene.RemoveNode(node)


def findOrAddNode(scene: Any, className: str, role: str, name: str) -> Any:
    """Return the node of the class with the role, added under `name` where there is none."""
    node = findNode(scene, className, role)
    if node is None:
        node = addNode(scene, className, role, name)
        if node.IsA("vtkMRMLDisplayableNode"):
            node.CreateDefaultDisplayNodes()
    return node


def setValues(thing: Any, **values: Any) -> Any:
    """Call `Set…` of a VTK object for each value and return it; a node reports one change."""
    isNode = thing.IsA("vtkMRMLNode")
    with slicer.util.NodeModify(thing) if isNode else contextlib.nullcontext():
        for name, value in values.items():
            getattr(thing, f"Set{name}")(value)
    return thing


def setDisplay(node: Any, **values: Any) -> Any:
    """Call `Set…` of a node's display for each value; return the display."""
    return setValues(node.GetDisplayNode(), **values)


SELECTION = "vtkMRMLSelectionNodeSingleton"
INTERACTION = "vtkMRMLInteractionNodeSingleton"


def addNode(scene: Any, className: str, role: str, name: str) -> Any:
    """Add a node of ours, without display.

    Slicer has the next click place a point of the newest list; while the user is placing points,
    they still go into the user's list.
    """
    selection, interaction = scene.GetNodeByID(SELECTION), scene.GetNodeByID(INTERACTION)
    isPlacing = interaction and interaction.GetCurrentInteractionMode() == interaction.Place
    active = scene.GetNodeByID(selection.GetActivePlaceNodeID() or "") if isPlacing else None
    node = scene.AddNewNodeByClass(className, name)
    node.SetAttribute(ROLE_ATTRIBUTE, role)
    if active is not None:
        selection.SetReferenceActivePlaceNodeClassName(active.GetClassName())
        selection.SetActivePlaceNodeID(active.GetID())
    return node


TASK_ATTRIBUTE = "RASTrainer.task"
CONTENT_ATTRIBUTE = "RASTrainer.content"
"""Stamp of a node's content: a rebuilt scenario may keep its name."""


def surfaceOf(model: Any | None) -> tuple:
    """Return a value that changes with the surface of a model; empty without one."""
    if model is None or model.GetPolyData() is None or model.GetPolyData().GetPoints() is None:
        return ()
    return model.GetID(), model.GetPolyData().GetPoints().GetMTime()


def labelsOf(node: Any) -> tuple[str, ...]:
    return tuple(labelOf(node, i) for i in range(node.GetNumberOfControlPoints()))


def labelOf(node: Any, index: int) -> str:
    """Return a point's label; a peer may have sent bytes that are not UTF-8."""
    return shownText(node.GetNthControlPointLabel(index))


def isUsed(node: Any, index: int) -> bool:
    isPlaced = node.GetNthControlPointPositionStatus(index) == node.PositionDefined
    return isPlaced and bool(node.GetNthControlPointSelected(index))


def worldPoints(node: Any) -> np.ndarray:
    """Return the points where Slicer shows them, (n, 3) float, RAS mm."""
    return slicer.util.arrayFromMarkupsControlPoints(node, world=True)


def usedPoints(node: Any, points: np.ndarray, labels: tuple[str, ...]) -> PointList:
    """Return the points, of (n, 3) mm, that Slicer would use, with their labels."""
    unused = {row: label for row, label in enumerate(labels) if not isUsed(node, row)}
    rows = [row for row in range(len(labels)) if row not in unused]
    return PointList(tuple(labels[row] for row in rows), points[rows], unused)


def setPoints(node: Any, labels: Sequence[str], points: Any) -> None:
    """Replace the points of a `vtkMRMLMarkupsNode` by (n, 3) numbers, mm, in its own frame."""
    with slicer.util.NodeModify(node):
        node.RemoveAllControlPoints()
        places = np.asarray(points, dtype=float).reshape(-1, 3)
        slicer.util.updateMarkupsControlPointsFromArray(node, places)
        for index, label in enumerate(labels):
            node.SetNthControlPointLabel(index, label)


ORIGINAL_NAME = "OriginalNodeName"
"""The attribute in which Slicer's connector keeps the name of the device that fills a node."""

TOUCH_COLOR = (0.95, 0.55, 0.1)
TOUCH_LOOK = {"SelectedColor": TOUCH_COLOR, "GlyphScale": 2.5, "TextScale": 3.5}
POINT_PIXELS = 5.0


def prepareNodes(scene: Any) -> Iterator[Any]:
    """Make the nodes that are missing, one at each step, and yield all.

    The connector adopts nodes of that name and class; nodes that it has made itself are adopted.
    """
    yield capturedPointsNode(scene)
    yield simStateNode(scene)
    tips = (DeviceName.TOOL_TIP_TO_WORLD, DeviceName.INSTRUMENT_TIP_TO_WORLD)
    for device in (*tips, *DeviceName.LINK_TO_WORLD):
        yield poseNode(scene, device)


def poseNode(scene: Any, device: str) -> Any:
    """Return the transform that the connector fills for a device, or a new one; never saved."""
    return setValues(_adopted(scene, TRANSFORM, device, device), SaveWithScene=False)


def capturedPointsNode(scene: Any) -> Any:
    """Return the list of touched points (World, mm) under any name, or add it."""
    node = findNode(scene, LIST, Role.CAPTURED_POINTS)
    if node is None:
        node = _adopted(scene, LIST, Role.CAPTURED_POINTS, DeviceName.CAPTURED_POINTS)
        node.SetLocked(True)
        node.CreateDefaultDisplayNodes()
        setDisplay(node, **TOUCH_LOOK, OccludedVisibility=True)
    return node


def simStateNode(scene: Any) -> Any:
    """Return the text of the simulator's state, or a new one; it is never saved."""
    node = _adopted(scene, TEXT, Role.SIM_STATE, DeviceName.SIM_STATE)
    return setValues(node, SaveWithScene=False)


def drawAsPoints(node: Any) -> None:
    node.SetSelectable(False)
    points = slicer.vtkMRMLDisplayNode.PointsRepresentation
    setDisplay(
        node, Representation=points, PointSize=POINT_PIXELS, Color=TOUCH_COLOR, Lighting=False
    )


def _adopted(scene: Any, className: str, role: str, name: str) -> Any:
    """Return the node with the role, else with the name, else a new node."""
    node = findNode(scene, className, role)
    if node is None:
        node = scene.GetFirstNode(name, className) or addNode(scene, className, role, name)
        node.SetAttribute(ROLE_ATTRIBUTE, role)
    return node


def decodedText(text: str | bytes | None) -> str:
    """Return the text, empty for None."""
    if isinstance(text, bytes):
        raise InputError("The text must be encoded in UTF-8.")
    return text or ""


def shownText(text: str | bytes | None) -> str:
    """Return a text for display, such as a label, with bytes that are not UTF-8 replaced."""
    return text.decode("utf-8", "replace") if isinstance(text, bytes) else text or ""
