"""Counts how often Slicer would render its views."""

from __future__ import annotations

from typing import Any

import slicer
import vtk
from PySide6 import QtCore

RENDERED_CLASSES = ("vtkMRMLTransformNode", "vtkMRMLDisplayableNode")
EVENTS = (
    vtk.vtkCommand.ModifiedEvent,
    slicer.vtkMRMLTransformableNode.TransformModifiedEvent,
    slicer.vtkMRMLDisplayableNode.DisplayModifiedEvent,
)


class RenderCounter:
    """Counts as Slicer was measured to render.

    Each change of a transform or of what can be shown is a reason to render, also one to the same
    matrix, of a hidden node, in any module. All changes in one turn of the event loop make
    one rendering.
    """

    def __init__(self, scene: Any) -> None:
        self.count = 0
        self._is_due = False
        scene.AddObserver(scene.NodeAddedEvent, self._node_added)
        scene.AddObserver(scene.NodeRemovedEvent, self._node_removed)

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _node_added(self, _scene: Any, _event: str, node: Any) -> None:
        if any(node.IsA(name) for name in RENDERED_CLASSES):
            for event in EVENTS:
                node.AddObserver(event, self._request)
            self._request()

    @vtk.calldata_type(vtk.VTK_OBJECT)
    def _node_removed(self, _scene: Any, _event: str, node: Any) -> None:
        if any(node.IsA(name) for name in RENDERED_CLASSES):
            self._request()

    def _request(self, *_event: Any) -> None:
        if not self._is_due:
            self._is_due = True
            QtCore.QTimer.singleShot(0, self._render)

    def _render(self) -> None:
        self._is_due = False
        self.count += 1
