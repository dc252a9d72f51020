"""Our nodes in the scene: what each is, found, made or removed, with its content and its points."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import slicer
import vtk

from rastrainer.errors import InputError
from rastrainer.files.point_list import PointList
from rastrainer.procedure.errors import PLACED_COLOR, PLANNED_COLOR, REGISTERED_COLOR
from rastrainer.protocol import DeviceName
from rastrainer.slicer.translation import _

MODEL, SEGMENTATION = "vtkMRMLModelNode", "vtkMRMLSegmentationNode"
VOLUME, TABLE = "vtkMRMLScalarVolumeNode", "vtkMRMLTableNode"
LIST, LINE = "vtkMRMLMarkupsFiducialNode", "vtkMRMLMarkupsLineNode"
TRANSFORM, TEXT = "vtkMRMLLinearTransformNode", "vtkMRMLTextNode"

ROLE_ATTRIBUTE = "RASTrainer.role"
TASK_ATTRIBUTE = "RASTrainer.task"
CONTENT_ATTRIBUTE = "RASTrainer.content"
"""Stamp of a node's content: a rebuilt scenario may keep its name."""
ORIGINAL_NAME = "OriginalNodeName"
"""The attribute in which Slicer's connector keeps the name of the device that fills a node."""


@dataclass(frozen=True, eq=False)
class NodeKind:
    """Our nodes of one purpose, with the values that they and their displays (`look`) have.

    The role marks them; it survives renaming, saving and loading.
    """

    className: str
    role: str
    name: str = ""
    look: Mapping[str, Any] = field(default_factory=dict)
    values: Mapping[str, Any] = field(default_factory=dict)

    def all(self, scene: Any) -> list[Any]:
        nodes = nodesOfClass(scene, self.className)
        return [node for node in nodes if node.GetAttribute(ROLE_ATTRIBUTE) == self.role]

    def find(self, scene: Any) -> Any | None:
        return next(iter(self.all(scene)), None)

    def make(self, scene: Any, name: str = "") -> Any:
        """Return the node, with its look, and the name if one is given; add a missing one."""
        node = self.find(scene)
        return self.add(scene, name) if node is None else self.dress(node, name)

    def add(self, scene: Any, name: str = "") -> Any:
        """Add a node and return it.

        Slicer has the next click place a point of the newest list; while the user is placing
        points, they still go into the user's list.
        """
        selection, interaction = placingNodes(scene)
        isPlacing = interaction and interaction.GetCurrentInteractionMode() == interaction.Place
        active = scene.GetNodeByID(selection.GetActivePlaceNodeID() or "") if isPlacing else None
        node = scene.AddNewNodeByClass(self.className, name or self.name)
        if active is not None:
            selection.SetReferenceActivePlaceNodeClassName(active.GetClassName())
            selection.SetActivePlaceNodeID(active.GetID())
        return self.dress(node)

    def remove(self, scene: Any) -> None:
        for node in self.all(scene):
            removeNode(node)

    def dress(self, node: Any, name: str = "") -> Any:
        """Make a node one of this kind and return it."""
        node.SetAttribute(ROLE_ATTRIBUTE, self.role)
        setValues(node, **self.values, **({"Name": name} if name else {}))
        if node.IsA("vtkMRMLDisplayableNode") and self.className != TRANSFORM:
            node.CreateDefaultDisplayNodes()
            setDisplay(node, **self.look)
        return node


class LinkedKind(NodeKind):
    """A node that Slicer's connector fills; what the user makes of its look stays.

    The connector adopts a node of that name and class; a node that it has made itself is adopted.
    """

    def find(self, scene: Any) -> Any | None:
        return super().find(scene) or scene.GetFirstNode(self.name, self.className)

    def make(self, scene: Any, name: str = "") -> Any:
        return super().find(scene) or super().make(scene, name)


def placingNodes(scene: Any) -> tuple[Any, Any]:
    """Return the selection and the interaction node, which say what a click places."""
    selection = scene.GetNodeByID("vtkMRMLSelectionNodeSingleton")
    return selection, scene.GetNodeByID("vtkMRMLInteractionNodeSingleton")


def removeNode(node: Any) -> None:
    """Remove a node from its scene, and its display, which would stay and be saved."""
    scene = node.GetScene()
    display = node.GetDisplayNode() if node.IsA("vtkMRMLDisplayableNode") else None
    for each in filter(None, (display, node)):
        scene.RemoveNode(each)


def releaseNode(node: Any) -> None:
    """Hide a node, which is none of ours from now on, but the user's own."""
    node.RemoveAttribute(ROLE_ATTRIBUTE)
    node.SetDisplayVisibility(False)


def nodesOfClass(scene: Any, className: str) -> list[Any]:
    """Return all nodes of the class or of classes derived from it, in the scene's order."""
    nodes = scene.GetNodesByClass(className)
    nodes.UnRegister(None)
    return [nodes.GetItemAsObject(index) for index in range(nodes.GetNumberOfItems())]


Color = tuple[float, float, float]
LOCKED, UNSAVED, UNSELECTABLE = {"Locked": True}, {"SaveWithScene": False}, {"Selectable": False}
TOUCH_COLOR = (0.95, 0.55, 0.1)
SKIN_COLOR = (0.87, 0.72, 0.62)
TRACE_LOOK = {
    "Representation": slicer.vtkMRMLDisplayNode.PointsRepresentation,
    "PointSize": 5.0,
    "Color": TOUCH_COLOR,
    "Lighting": False,
}

TOUCH_LOOK = {"SelectedColor": TOUCH_COLOR, "GlyphScale": 2.5, "TextScale": 3.5}
FIDUCIAL_LOOK = {"SelectedColor": (0.25, 0.55, 0.95), "GlyphScale": 2.0, "TextScale": 3.5}
TARGET_LOOK = {"SelectedColor": (0.2, 0.75, 0.35)}
ON_TOP = {"OccludedVisibility": True}
PLAN_LOOK = {"SelectedColor": (0.85, 0.2, 0.55), **ON_TOP}
LANDMARK_LOOK = {"SelectedColor": (0.1, 0.55, 0.9), **ON_TOP}
NEXT_LOOK = {"SelectedColor": (0.75, 0.0, 0.5), "GlyphScale": 4.0, "TextScale": 3.5, **ON_TOP}
"""Far from the trace, the head is yellow."""
COLORS = "color"
LINK_LOOK = {
    **UNSAVED,
    "ActiveScalarName": COLORS,
    "ActiveAttributeLocation": vtk.vtkAssignAttribute.POINT_DATA,
    "ScalarRangeFlag": slicer.vtkMRMLDisplayNode.UseDirectMapping,
    "ScalarVisibility": True,
}
LINE_LOOK = {**ON_TOP, "PropertiesLabelVisibility": False, "GlyphScale": 1.0, "TextScale": 2.5}


def _procedureLine(role: str, name: str, color: Color, isLabeled: bool = False) -> NodeKind:
    look = {**LINE_LOOK, "SelectedColor": color, "PointLabelsVisibility": isLabeled}
    return NodeKind(LINE, f"procedure {role} line", name, look, LOCKED)


def _solid(role: str, name: str, color: Color) -> NodeKind:
    return NodeKind(MODEL, f"procedure {role}", name, {"Color": color, "Visibility2D": True})


def _chart(role: str, name: str, xTitle: str, yTitle: str) -> NodeKind:
    ranges = {"XAxisRangeAuto": False, "YAxisRangeAuto": False}
    axes = {"XAxisTitle": xTitle, "YAxisTitle": yTitle, **ranges}
    return NodeKind("vtkMRMLPlotChartNode", role, name, {}, axes)


def _table(role: str, name: str = "") -> NodeKind:
    return NodeKind(TABLE, role, name, {}, LOCKED)


class Role:
    """Our kinds of nodes."""

    HEAD_MODEL = NodeKind(MODEL, "head model", "Head")
    HEAD_PREVIEW = NodeKind(MODEL, "head preview", "Head as found", {"Color": SKIN_COLOR})
    HEAD_SEGMENT = NodeKind(SEGMENTATION, "head segment", "Head to be edited")
    HEAD_VOLUME = NodeKind(VOLUME, "head volume")
    SKULL = NodeKind(MODEL, "skull", "Skull")
    FIXED_FIDUCIALS = NodeKind(LIST, "fixed fiducials", "", FIDUCIAL_LOOK, LOCKED)
    TARGET = NodeKind(LIST, "target", "Targets", TARGET_LOOK, LOCKED)
    TRAJECTORY = NodeKind(LINE, "trajectory", "", TARGET_LOOK, LOCKED)
    CAPTURED_POINTS = LinkedKind(
        LIST, "captured points", DeviceName.CAPTURED_POINTS, {**TOUCH_LOOK, **ON_TOP}, LOCKED
    )
    SIM_STATE = LinkedKind(TEXT, "simulator state", DeviceName.SIM_STATE, {}, UNSAVED)
    WORLD_TO_HEAD = NodeKind(TRANSFORM, "world to head", "WorldToHead")
    RESIDUALS = _table("residuals", "Residuals")
    RESIDUAL_ARROWS = NodeKind(MODEL, "residual arrows", "Residual arrows")
    FITS = _table("fits", "Fits")
    HISTORY = _table("history")
    LEARNING_TABLE = _table("learning curve")
    LEARNING_CURVE = _chart("learning curve", "", "Trial", "Score, and completion time in s")
    CALIBRATION = _chart(
        "calibration", "True against expected TRE", _("Expected TRE (mm)"), _("True TRE (mm)")
    )
    CALIBRATION_TABLE = _table("calibration", "True and expected TRE")
    CALIBRATION_LINE = _table("calibration line", "True equals expected TRE")
    SCORE = _table("score", "Score")
    COMPARISON = _table("comparison", "Comparison")
    MOTION = _table("motion metrics", "Motion metrics")
    PLAN_TARGET = NodeKind(LIST, "plan target", _("Planned target"), PLAN_LOOK)
    PLAN_TRAJECTORY = NodeKind(LINE, "plan trajectory", _("Planned trajectory"), PLAN_LOOK)
    PLAN_LINE = NodeKind(LINE, "procedure plan line", _("Line"), PLAN_LOOK)
    NO_GO = _solid("no-go structure", "", (0.8, 0.2, 0.2))
    CHECKPOINTS = NodeKind(LIST, "procedure checkpoints", _("Checkpoints"))
    PLANNED_LINE = _procedureLine("planned", "{}", PLANNED_COLOR, True)
    REGISTERED_LINE = _procedureLine("registered", _("{}, registered"), REGISTERED_COLOR)
    TRUE_LINE = _procedureLine("true", _("{}, true"), PLACED_COLOR)
    ERRORS_BY_REGISTRATION = _solid(
        "errors by registration", _("Errors due to registration"), REGISTERED_COLOR
    )
    ERRORS_BY_HAND = _solid("errors by hand", _("Errors due to hand or robot"), PLACED_COLOR)
    PROCEDURE_ERRORS = _table("procedure errors", "Procedure errors")
    LANDMARKS = NodeKind(LIST, "landmarks", _("Landmarks"), LANDMARK_LOOK)
    TRACED_POINTS = NodeKind(MODEL, "traced points", _("Traced points"), TRACE_LOOK, UNSELECTABLE)
    NEXT_PLACE = NodeKind(LIST, "next place of the trace", _("Draw here next"), NEXT_LOOK, LOCKED)
    LINKS = tuple(
        NodeKind(
            MODEL, f"robot link {n}", f"Robot link {n}", LINK_LOOK, {**UNSAVED, **UNSELECTABLE}
        )
        for n in range(len(DeviceName.LINK_TO_WORLD))
    )
    """The robot's links, rebuilt from the module's files; the tool belongs to the last link."""


TOOLS = DeviceName.TOOL_TIP_TO_WORLD, DeviceName.INSTRUMENT_TIP_TO_WORLD


def poseKind(device: str) -> NodeKind:
    """Return the kind of the transform that the connector fills for a device; never saved."""
    return LinkedKind(TRANSFORM, device, device, {}, UNSAVED)


def prepareNodes(scene: Any) -> Iterator[Any]:
    """Make the nodes of the link that are missing, one at each step, and yield all."""
    poses = map(poseKind, (*TOOLS, *DeviceName.LINK_TO_WORLD))
    for kind in (Role.CAPTURED_POINTS, Role.SIM_STATE, *poses):
        yield kind.make(scene)


def setValues(thing: Any, **values: Any) -> Any:
    """Call `Set…` of a VTK object for each value and return it; a node reports one change."""
    isNode = thing.IsA("vtkMRMLNode")
    with slicer.util.NodeModify(thing) if isNode else contextlib.nullcontext():
        for name, value in values.items():
            getattr(thing, f"Set{name}")(value)
    return thing


def setDisplay(node: Any, **values: Any) -> Any:
    return setValues(node.GetDisplayNode(), **values)


def surfaceOf(model: Any | None) -> tuple:
    """Return a value that changes with the surface of a model; empty without one."""
    if model is None or model.GetPolyData() is None or model.GetPolyData().GetPoints() is None:
        return ()
    return model.GetID(), model.GetPolyData().GetPoints().GetMTime()


def labelsOf(node: Any) -> tuple[str, ...]:
    return tuple(
        shownText(node.GetNthControlPointLabel(row))
        for row in range(node.GetNumberOfControlPoints())
    )


def isUsed(node: Any, index: int) -> bool:
    isPlaced = node.GetNthControlPointPositionStatus(index) == node.PositionDefined
    return isPlaced and bool(node.GetNthControlPointSelected(index))


def worldPoints(node: Any) -> np.ndarray:
    """Return the points where Slicer shows them, (n, 3) float, RAS mm."""
    return slicer.util.arrayFromMarkupsControlPoints(node, world=True)


def usedPoints(
    node: Any, points: np.ndarray | None = None, labels: tuple[str, ...] | None = None
) -> PointList:
    """Return the points, of (n, 3) mm or the node's own in RAS, that Slicer would use."""
    points = worldPoints(node) if points is None else points
    labels = labelsOf(node) if labels is None else labels
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


def decodedText(text: str | bytes | None) -> str:
    """Return the text, empty for None."""
    if isinstance(text, bytes):
        raise InputError("The text must be encoded in UTF-8.")
    return text or ""


def shownText(text: str | bytes | None) -> str:
    """Return a text, such as a label by a peer, with bytes that are not UTF-8 replaced."""
    return text.decode("utf-8", "replace") if isinstance(text, bytes) else text or ""
