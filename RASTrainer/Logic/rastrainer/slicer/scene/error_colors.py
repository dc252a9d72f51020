"""Errors as colors, in mm: the head by the expected target error, and the legend in the 3D view."""

from __future__ import annotations

from typing import Any

import numpy as np
import slicer
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from rastrainer.registration.localization_error import LocalizationError
from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import expected_tre
from rastrainer.slicer.scene.scene import nodesOfClass

COLOR_TABLE_ID = "vtkMRMLColorTableNodeFileViridis.txt"
"""One of the color tables that every Slicer has; readable without color vision, too."""
CLASS_NAME = "vtkMRMLColorLegendDisplayNode"
RANK_ATTRIBUTE = "RASTrainer.legendRank"
"""On a legend of ours: which is shown where several are wanted; the highest, never 0."""
ARROWS_RANK, HEAD_RANK = 1, 2
SIZE = (0.1, 0.35)
"""Width and height as shares of the view."""
PLACE = (0.98, 0.5)
SCALARS = "expected TRE (mm)"


def showScalars(model: Any, name: str, ends: tuple[float, float]) -> None:
    """Color a `vtkMRMLModelNode` by point data of that name, whose colors have these ends."""
    display = model.GetDisplayNode()
    display.SetActiveScalar(name, vtk.vtkAssignAttribute.POINT_DATA)
    display.SetAndObserveColorNodeID(COLOR_TABLE_ID)
    display.SetScalarRangeFlag(display.UseManualScalarRange)
    display.SetScalarRange(*ends)
    display.SetScalarVisibility(True)


def showLegend(node: Any, title: str, rank: int) -> Any | None:
    """Show the legend of a colored `vtkMRMLDisplayableNode`, unless one of higher rank is shown.

    The slices stay free of it. Returns the legend, or None where the scene knows no legends: only
    Slicer's module Colors brings them.
    """
    if not node.GetScene().IsNodeClassRegistered(CLASS_NAME):
        return None
    legend = slicer.vtkSlicerColorLogic.GetColorLegendDisplayNode(node)
    if legend is None:
        legend = slicer.vtkSlicerColorLogic.AddDefaultColorLegendDisplayNode(node)
        legend.SetVisibility2D(False)
        legend.SetSize(*SIZE)
        legend.SetPosition(*PLACE)
        legend.SetLabelFormat("%.2f")
    legend.SetTitleText(title)
    legend.SetAttribute(RANK_ATTRIBUTE, str(rank))
    _showHighest(node.GetScene())
    return legend


def hideLegend(node: Any) -> None:
    """Hide the legend of a node, if it has one; another that is wanted takes its place."""
    legend = slicer.vtkSlicerColorLogic.GetColorLegendDisplayNode(node)
    if legend is not None:
        legend.SetAttribute(RANK_ATTRIBUTE, "0")
        _showHighest(node.GetScene())


def _showHighest(scene: Any) -> None:
    found = nodesOfClass(scene, CLASS_NAME)
    ranks = {legend: int(legend.GetAttribute(RANK_ATTRIBUTE) or 0) for legend in found}
    # What has no rank is none of ours; a legend may have outlived what it belongs to.
    ours = [legend for legend in found if legend.GetAttribute(RANK_ATTRIBUTE) is not None]
    wanted = [legend for legend in ours if ranks[legend] and _isSeen(legend.GetDisplayableNode())]
    highest = max(wanted, key=lambda legend: ranks[legend], default=None)
    for legend in ours:
        legend.SetVisibility(legend is highest)


def _isSeen(node: Any | None) -> bool:
    return node is not None and bool(node.GetDisplayVisibility())


def colorHead(
    model: Any, registration: Registration, localization: LocalizationError | None = None
) -> tuple[float, float]:
    """Color a `vtkMRMLModelNode` by the expected TRE, and return least and largest of it, mm.

    Args:
        model: the head.
        registration: whose error is shown.
        localization: of the touches; alike in all directions where left out.

    Raises:
        InputError: the registration has too few points to tell.
    """
    points = slicer.util.arrayFromModelPoints(model).astype(float)
    errors = expected_tre(registration, points, localization)
    scalars = numpy_to_vtk(errors, deep=True)
    scalars.SetName(SCALARS)
    model.GetPolyData().GetPointData().AddArray(scalars)
    model.GetPolyData().Modified()
    low, high = float(errors.min()), float(errors.max())
    showScalars(model, SCALARS, colorRange(low, high))
    showLegend(model, "TRE (mm)", HEAD_RANK)
    return low, high


def colorRange(low: float, high: float) -> tuple[float, float]:
    """Return round ends of the colors, in tenths of a mm, never equal."""
    bottom, top = np.floor(10.0 * low) / 10.0, np.ceil(10.0 * high) / 10.0
    return float(bottom), float(max(top, bottom + 0.1))


def uncolorHead(model: Any) -> None:
    """Show the head in its own color again."""
    display = model.GetDisplayNode()
    if display is not None and display.GetActiveScalarName() == SCALARS:
        display.SetScalarVisibility(False)
        hideLegend(model)
