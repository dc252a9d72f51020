"""A MRML scene in plain Python, and what Slicer's connector makes of a message.

Needs the package `slicer-core`; desktop Slicer has its own scene and connector, and never loads
this file.
"""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import slicer
import vtk

from rastrainer.errors import InputError
from rastrainer.igtl.content import Point, Points, Status, String, Transform
from rastrainer.igtl.message import Message
from rastrainer.slicer.scene.nodes import ORIGINAL_NAME

SLICES = {"Red": "Axial", "Green": "Coronal", "Yellow": "Sagittal"}
"""Slicer's own slice views and how they are cut."""


class HeadlessScene:
    """Owns a `vtkMRMLScene` and the logics without which nodes lose their storage or defaults."""

    def __init__(self) -> None:
        self.scene = slicer.vtkMRMLScene()
        self._applicationLogic = slicer.vtkSlicerApplicationLogic()
        self._applicationLogic.SetMRMLScene(self.scene)
        # The first registers the storage of markups: without it, bundles would be saved without
        # points. The second shows the item of each Sequence that its browser has chosen. In a saved
        # scene the slice views show the images.
        slices = [slicer.vtkMRMLSliceLogic() for _ in SLICES]
        self._logics = [slicer.vtkSlicerMarkupsLogic(), slicer.vtkSlicerSequencesLogic(), *slices]
        for logic in self._logics:
            logic.SetMRMLApplicationLogic(self._applicationLogic)
            logic.SetMRMLScene(self.scene)
        for logic, (name, axes) in zip(slices, SLICES.items(), strict=True):
            logic.AddSliceNode(name).SetOrientation(axes)

    def save(self, path: Path) -> None:
        """Write the scene and all its files as one bundle (.mrb), whole or not at all."""
        messages = slicer.vtkMRMLMessageCollection()
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=".saving-") as folder:
            unfinished = Path(folder, path.name)
            if not self.scene.WriteToMRB(str(unfinished), None, messages):
                raise InputError(
                    f"The scene could not be saved as {path}: {messages.GetAllMessagesAsString()}"
                )
            unfinished.replace(path)


METADATA_PREFIX = "OpenIGTLink."


class HeadlessStatusNode(slicer.vtkMRMLScriptedModuleNode):
    """A stand-in of `vtkMRMLIGTLStatusNode`, which comes with the extension."""

    def __init__(self) -> None:
        self.status = Status(0)
        self.SetSaveWithScene(False)

    def GetSubCode(self) -> int:
        return self.status.subcode


NODE_CLASS = {
    Transform.TYPE: "vtkMRMLTransformNode",
    String.TYPE: "vtkMRMLTextNode",
    Points.TYPE: "vtkMRMLMarkupsFiducialNode",
    Status.TYPE: "vtkMRMLScriptedModuleNode",
}
"""Class of the node that each type is put into; Slicer knows more types, which we never send."""


def asSlicerHas(text: str) -> str | bytes:
    """Return a text of a message as VTK hands it to Python: as bytes if it is not UTF-8."""
    data = text.encode("utf-8", "surrogateescape")
    try:
        return data.decode("utf-8")
    except UnicodeDecodeError:
        return data


def adoptOrCreateNode(scene: Any, messageType: str, deviceName: str) -> Any:
    """Return the node for a device: one of that name and class that is there, or a new one."""
    name = deviceName or "OpenIGTLink"
    node = scene.GetFirstNode(name, NODE_CLASS[messageType])
    if node is None:
        if messageType == Status.TYPE:
            node = HeadlessStatusNode()
            node.SetName(name)
            scene.AddNode(node)
        else:
            isTransform = messageType == Transform.TYPE
            className = "vtkMRMLLinearTransformNode" if isTransform else NODE_CLASS[messageType]
            node = scene.AddNewNodeByClass(className, name)
        if messageType == Points.TYPE:
            node.CreateDefaultDisplayNodes()
        node.SetDescription("Received by OpenIGTLink")
    node.SetAttribute(ORIGINAL_NAME, name)
    return node


def updateNode(node: Any, message: Message) -> None:
    content = message.content
    if isinstance(content, Transform):
        matrix = vtk.vtkMatrix4x4()
        matrix.DeepCopy([value for row in content.matrix for value in row])
        node.SetMatrixTransformToParent(matrix)
        node.Modified()
    elif isinstance(content, String):
        node.SetText(asSlicerHas(content.text.partition("\0")[0]))
        node.Modified()
    elif isinstance(content, Points):
        if content.points or message.metadata:
            _updatePoints(node, content.points)
    else:
        node.status = content
        node.Modified()
    for key, value in message.metadata.items():
        node.SetAttribute(METADATA_PREFIX + key, asSlicerHas(value))
        if isinstance(content, Transform) and "Status" in key:
            node.SetAttribute(key, asSlicerHas(value))


def _updatePoints(node: Any, points: Sequence[Point]) -> None:
    while node.GetNumberOfControlPoints() > len(points):
        node.RemoveNthControlPoint(node.GetNumberOfControlPoints() - 1)
    for index, point in enumerate(points):
        label, isNew = asSlicerHas(point.label), index >= node.GetNumberOfControlPoints()
        if isNew:
            node.AddControlPoint(vtk.vtkVector3d(point.position), label)
        else:
            node.SetNthControlPointLabel(index, label)
            node.SetNthControlPointPosition(index, point.position)
        node.SetNthControlPointVisibility(index, point.color[3] > 0)
    display = node.GetDisplayNode()
    if display is not None and points:
        display.SetSelectedColor([channel / 255.0 for channel in points[0].color[:3]])
