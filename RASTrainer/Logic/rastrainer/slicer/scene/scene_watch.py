"""Notices that something in the scene has changed, so that nothing is looked at again and again."""

from __future__ import annotations

from typing import Any

import slicer
import vtk

from rastrainer.slicer.scene.nodes import ROLE_ATTRIBUTE, TOOLS, Role
from rastrainer.slicer.signal import Signal

_MARKUPS = slicer.vtkMRMLMarkupsNode
_MODIFIED = vtk.vtkCommand.ModifiedEvent
_MOVED = slicer.vtkMRMLTransformableNode.TransformModifiedEvent
_SHOWN = slicer.vtkMRMLDisplayableNode.DisplayModifiedEvent
CONTENT = {
    "vtkMRMLMarkupsNode": (
        _MODIFIED,
        _MOVED,
        _MARKUPS.PointAddedEvent,
        _MARKUPS.PointRemovedEvent,
        _MARKUPS.PointModifiedEvent,
        _MARKUPS.PointPositionDefinedEvent,
    ),
    "vtkMRMLModelNode": (_MODIFIED, _SHOWN, slicer.vtkMRMLModelNode.MeshModifiedEvent),
    "vtkMRMLSegmentationNode": (_MODIFIED, _SHOWN),
    "vtkMRMLVolumeNode": (_MODIFIED,),
    "vtkMRMLLayoutNode": (_MODIFIED,),
    "vtkMRMLSequenceBrowserNode": (_MODIFIED,),
}
"""Events of what the panels show, by class."""
TRANSFORM, TEXT = "vtkMRMLTransformNode", "vtkMRMLTextNode"


class SceneWatch:
    """Observes nodes of the classes in `CONTENT`, transforms and texts while they are in the scene.

    Attributes:
        noticed: emits nothing, from inside VTK, whenever something is to be looked at soon.
        hasChanged: whether the panels' content has changed; its reader resets it.
    """

    def __init__(self, scene: Any) -> None:
        self.noticed = Signal()
        self._scene = scene
        self.hasChanged = True
        self._tags: dict[str, list[int]] = {}
        self._sceneTags = [
            scene.AddObserver(scene.NodeAddedEvent, self._noteAdded),
            scene.AddObserver(scene.NodeRemovedEvent, self._noteRemoved),
            scene.AddObserver(scene.EndBatchProcessEvent, self._noteChange),
        ]
        for index in range(scene.GetNumberOfNodes()):
            self._observe(scene.GetNthNode(index))

    def close(self) -> None:
        for tag in self._sceneTags:
            self._scene.RemoveObserver(tag)
        for nodeId in list(self._tags):
            self._forget(self._scene.GetNodeByID(nodeId), nodeId)

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _noteAdded(self, _scene: Any, _event: str, node: Any) -> None:
        self._observe(node)
        self._noteChange()

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _noteRemoved(self, _scene: Any, _event: str, node: Any) -> None:
        self._forget(node, node.GetID())
        self._noteChange()

    def _observe(self, node: Any) -> None:
        tags = [
            node.AddObserver(event, self._noteChange)
            for kind, events in CONTENT.items()
            if node.IsA(kind)
            for event in events
        ]
        if node.IsA(TRANSFORM):
            tags.append(node.AddObserver(_MOVED, self._noteIncoming))
        elif node.IsA(TEXT):
            tags.append(node.AddObserver(node.TextModifiedEvent, self._noteIncoming))
        if tags:
            self._tags[node.GetID()] = tags

    def _forget(self, node: Any | None, nodeId: str) -> None:
        for tag in self._tags.pop(nodeId, ()):
            if node is not None:
                node.RemoveObserver(tag)

    def _noteChange(self, *_event: Any) -> None:
        self.hasChanged = True
        self.noticed.emit()

    def _noteIncoming(self, node: Any, _event: str) -> None:
        """Note the head, a tool or the state; the links of the robot move by themselves."""
        role = node.GetAttribute(ROLE_ATTRIBUTE)
        if role == Role.WORLD_TO_HEAD.role:
            self._noteChange()
        elif role in (*TOOLS, Role.SIM_STATE.role):
            self.noticed.emit()
