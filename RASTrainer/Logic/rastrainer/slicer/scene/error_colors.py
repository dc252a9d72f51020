"""Registration errors in the 3D view: colors on the head, arrows at the fiducials, a legend."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import slicer
import vtk

from rastrainer import transforms
from rastrainer.registration.registration import Registration
from rastrainer.slicer.polydata import vtkArray
from rastrainer.slicer.scene.nodes import Role, nodesOfClass, setValues, surfaceOf

COLOR_TABLE_ID = "vtkMRMLColorTableNodeFileViridis.txt"
"""One of the color tables that every Slicer has; readable without color vision, too."""
CLASS_NAME = "vtkMRMLColorLegendDisplayNode"
RANK_ATTRIBUTE = "RASTrainer.legendRank"
"""On a legend of ours: which is shown where several are wanted; the highest, never 0."""
ARROWS_RANK, HEAD_RANK = 1, 2
LEGEND = {"Size": (0.1, 0.35), "Position": (0.98, 0.5), "Visibility2D": False}
"""Width, height and place as shares of the view."""
TRE_SCALARS = "expected TRE (mm)"
OPACITY_ATTRIBUTE = "RASTrainer.opacity"
"""On a colored head: its opacity before it was colored. Colors are readable only at opacity 1."""


def _showColors(model: Any, name: str, ends: tuple[float, float], title: str, rank: int) -> None:
    """Color a model by its scalars; show their legend in 3D unless one of higher rank is shown."""
    display = model.GetDisplayNode()
    with slicer.util.NodeModify(display):
        display.SetActiveScalar(name, vtk.vtkAssignAttribute.POINT_DATA)
        display.SetAndObserveColorNodeID(COLOR_TABLE_ID)
        display.SetScalarRangeFlag(display.UseManualScalarRange)
        display.SetScalarRange(*ends)
        display.SetScalarVisibility(True)
    # Only Slicer's module Colors has legends.
    if model.GetScene().IsNodeClassRegistered(CLASS_NAME):
        logic = slicer.vtkSlicerColorLogic
        if logic.GetColorLegendDisplayNode(model) is None:
            legend = logic.AddDefaultColorLegendDisplayNode(model)
            setValues(legend, LabelFormat="%.2f", **LEGEND)
        logic.GetColorLegendDisplayNode(model).SetTitleText(title)
        _rankLegend(model, rank)


def _rankLegend(model: Any, rank: int) -> None:
    """Rank the legend of a model, if any, and show the legend of the highest rank."""
    changed = slicer.vtkSlicerColorLogic.GetColorLegendDisplayNode(model)
    if changed is None:
        return
    changed.SetAttribute(RANK_ATTRIBUTE, str(rank))
    ranks = {}
    for legend in nodesOfClass(model.GetScene(), CLASS_NAME):
        # A legend without a rank is not ours; one of ours may have outlived its model.
        if legend.GetAttribute(RANK_ATTRIBUTE) is not None:
            node, rank = legend.GetDisplayableNode(), int(legend.GetAttribute(RANK_ATTRIBUTE))
            ranks[legend] = rank if node is not None and node.GetDisplayVisibility() else 0
    highest = max(ranks, key=ranks.__getitem__)
    for legend in ranks:
        legend.SetVisibility(legend is highest and ranks[legend] > 0)


def colorHead(model: Any, errors: np.ndarray) -> None:
    """Color a `vtkMRMLModelNode`, the head, by the expected TRE (v,) at each of its points, mm."""
    # Round ends, in tenths of a mm, never equal.
    low = float(np.floor(10.0 * errors.min())) / 10.0
    high = float(np.ceil(10.0 * errors.max())) / 10.0
    colorSkin(model, TRE_SCALARS, errors, (low, max(high, low + 0.1)), "TRE (mm)")


def colorSkin(
    model: Any, name: str, values: np.ndarray, ends: tuple[float, float], title: str
) -> None:
    """Color a head by a value (v,) at each of its vertices, whose colors have these ends.

    A head with other vertices, which may have come since the values were requested, stays as it is.
    """
    if not surfaceOf(model) or model.GetPolyData().GetNumberOfPoints() != len(values):
        return
    display = model.GetDisplayNode()
    model.GetPolyData().GetPointData().AddArray(vtkArray(values, name))
    model.GetPolyData().Modified()
    if model.GetAttribute(OPACITY_ATTRIBUTE) is None:
        model.SetAttribute(OPACITY_ATTRIBUTE, str(display.GetOpacity()))
    display.SetOpacity(1.0)
    _showColors(model, name, ends, title, HEAD_RANK)


def removeHeadColors(model: Any, name: str = TRE_SCALARS) -> None:
    display = model.GetDisplayNode()
    if display is not None and display.GetActiveScalarName() == name:
        display.SetScalarVisibility(False)
        former = model.GetAttribute(OPACITY_ATTRIBUTE)
        if former:
            display.SetOpacity(float(former))
            model.RemoveAttribute(OPACITY_ATTRIBUTE)
        _rankLegend(model, 0)


LONGEST_ARROW_MM = 40.0
RESIDUAL_SCALARS = "residual (mm)"


def magnification(registration: Registration) -> float:
    """Return how many times as long as the residuals the arrows are, so that they can be seen."""
    largest = float(registration.residuals_mm.max())
    return next((m for m in (10.0, 5.0, 2.0) if m * largest <= LONGEST_ARROW_MM), 1.0)


def arrowTips(registration: Registration) -> np.ndarray:
    """Return where the arrows end, (n, 3) float, RAS mm."""
    return registration.fixed_mm + magnification(registration) * registration.residual_vectors_mm


def glyphsPolyData(registration: Registration, rows: Iterable[int] | None = None) -> Any:
    """Return a ball on each fiducial, or on those in `rows`, with an arrow along its residual.

    In RAS mm; its scalars are the residual in mm.
    """
    append = vtk.vtkAppendPolyData()
    tips = arrowTips(registration)
    for row in range(len(registration.labels)) if rows is None else rows:
        fixed, residual = registration.fixed_mm[row], float(registration.residuals_mm[row])
        ball = setValues(vtk.vtkSphereSource(), Center=fixed, Radius=2.2)
        setValues(ball, ThetaResolution=20, PhiResolution=20).Update()
        for data in (ball.GetOutput(), arrowPolyData(fixed, tips[row] - fixed)):
            values = np.full(data.GetNumberOfPoints(), residual)
            data.GetPointData().SetScalars(vtkArray(values, RESIDUAL_SCALARS))
            append.AddInputData(data)
    append.Update()
    return append.GetOutput()


def showResidualArrows(scene: Any, registration: Registration) -> Any:
    node = Role.RESIDUAL_ARROWS.make(scene)
    with slicer.util.NodeModify(node):
        node.SetDescription(f"Residuals, {magnification(registration):g} times as long")
        node.SetAndObservePolyData(glyphsPolyData(registration))
    _showColors(node, RESIDUAL_SCALARS, residualRange(registration), "Residual (mm)", ARROWS_RANK)
    return node


def clearResidualArrows(scene: Any) -> None:
    """Leave the arrows' model empty: there is no registration that they could show."""
    node = Role.RESIDUAL_ARROWS.find(scene)
    if node is not None and node.GetPolyData() and node.GetPolyData().GetNumberOfPoints():
        node.SetAndObservePolyData(vtk.vtkPolyData())
        _rankLegend(node, 0)


def residualRange(registration: Registration) -> tuple[float, float]:
    """Return the range of the colors, in mm: from 0 to the next whole mm, at least 2."""
    return 0.0, max(2.0, float(np.ceil(registration.residuals_mm.max())))


def arrowPolyData(start: np.ndarray, vector: np.ndarray, thickness: float = 1.0) -> vtk.vtkPolyData:
    """Return an arrow of length `vector` (3,), mm, whose `thickness` does not depend on it."""
    length = max(float(np.linalg.norm(vector)), 1e-6)
    arrow = setValues(
        vtk.vtkArrowSource(),
        TipResolution=16,
        ShaftResolution=12,
        TipLength=min(4.5 * thickness, 0.5 * length) / length,
        TipRadius=2.0 * thickness / length,
        ShaftRadius=0.8 * thickness / length,
    )
    # Its axes: along the arrow, and any two across.
    direction = vector / length
    across = np.cross(direction, np.eye(3)[int(np.argmin(np.abs(direction)))])
    across /= np.linalg.norm(across)
    axes = np.column_stack([direction, across, np.cross(direction, across)])
    place = vtk.vtkTransform()
    place.Concatenate(transforms.rigid(length * axes, start).ravel())
    placed = vtk.vtkTransformPolyDataFilter()
    setValues(placed, Transform=place, InputConnection=arrow.GetOutputPort()).Update()
    return placed.GetOutput()
