"""The trace of an open trial in the scene: its points, the covered skin, and where to draw next."""

from __future__ import annotations

from typing import Any

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from rastrainer.slicer.scene.control_points import setPoints
from rastrainer.slicer.scene.error_colors import colorSkin, uncolorHead
from rastrainer.slicer.scene.link_nodes import TOUCH_COLOR
from rastrainer.slicer.scene.scene import Role, findNode, findOrAddNode, removeNode
from rastrainer.slicer.translation import _
from rastrainer.trial.touch_registration import FollowedTrace

MODEL, MARKUPS = "vtkMRMLModelNode", "vtkMRMLMarkupsFiducialNode"
DISTANCE_SCALARS = "distance to the trace (mm)"
FARTHEST_MM = 20.0
"""What is farther from the trace has the color of this distance."""
NEXT_COLOR = (0.75, 0.0, 0.5)
"""Far from the trace, the head is yellow."""
POINT_PIXELS = 5.0


def showTrace(scene: Any, trace: FollowedTrace, isGuided: bool) -> None:
    """Show a trace on the head, RAS mm.

    Where the trainee is guided, the head is colored by the distance to the trace, and the place to
    draw next is marked.
    """
    node = findOrAddNode(scene, MODEL, Role.TRACED_POINTS, _("Traced points"))
    drawAsPoints(node)
    node.SetAndObservePolyData(pointCloud(trace.places))
    head = findNode(scene, MODEL, Role.HEAD_MODEL)
    if isGuided and len(trace.places):
        _colorHead(head, trace.away_mm)
    elif head is not None:
        uncolorHead(head, DISTANCE_SCALARS)
    _showNext(scene, trace.next_place if isGuided else None)


def drawAsPoints(node: Any) -> None:
    """Draw a model as the points of a trace."""
    node.SetSelectable(False)
    display = node.GetDisplayNode()
    display.SetRepresentation(display.PointsRepresentation)
    display.SetPointSize(POINT_PIXELS)
    display.SetColor(TOUCH_COLOR)
    display.SetLighting(False)


def forgetTrace(scene: Any) -> None:
    """Remove what is shown of a trace."""
    removeNode(scene, MODEL, Role.TRACED_POINTS)
    removeNode(scene, MARKUPS, Role.NEXT_PLACE)
    head = findNode(scene, MODEL, Role.HEAD_MODEL)
    if head is not None and head.GetPolyData() is not None:
        uncolorHead(head, DISTANCE_SCALARS)
        head.GetPolyData().GetPointData().RemoveArray(DISTANCE_SCALARS)


def pointCloud(places: np.ndarray) -> vtk.vtkPolyData:
    """Return places (n, 3) as points, each of them a vertex cell."""
    points, cells = vtk.vtkPoints(), vtk.vtkCellArray()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(places, dtype=np.float32), deep=True))
    for number in range(len(places)):
        cells.InsertNextCell(1, (number,))
    cloud = vtk.vtkPolyData()
    cloud.SetPoints(points)
    cloud.SetVerts(cells)
    return cloud


def _colorHead(head: Any | None, away_mm: np.ndarray) -> None:
    # Between the trial's scene and this trace another head may have been shown.
    if head is not None and head.GetPolyData().GetNumberOfPoints() == len(away_mm):
        near = np.minimum(away_mm, FARTHEST_MM)
        colorSkin(head, DISTANCE_SCALARS, near, (0.0, FARTHEST_MM), _("To trace (mm)"))


def _showNext(scene: Any, place: np.ndarray | None) -> None:
    if place is None:
        removeNode(scene, MARKUPS, Role.NEXT_PLACE)
        return
    node = findOrAddNode(scene, MARKUPS, Role.NEXT_PLACE, _("Draw here next"))
    setPoints(node, (_("Next"),), place[None])
    node.SetLocked(True)
    display = node.GetDisplayNode()
    display.SetSelectedColor(NEXT_COLOR)
    display.SetGlyphScale(4.0)
    display.SetTextScale(3.5)
    display.SetOccludedVisibility(True)
