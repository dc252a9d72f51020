"""Colored arrows from each fiducial towards where the registration puts its touched point."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
import vtk

from rastrainer.registration.registration import Registration
from rastrainer.slicer.scene.error_colors import ARROWS_RANK, hideLegend, showLegend, showScalars
from rastrainer.slicer.scene.scene import Role, findNode, findOrAddNode

LONGEST_ARROW_MM = 40.0
SCALARS = "residual (mm)"


def magnification(registration: Registration) -> float:
    """Return how many times as long as the residuals the arrows are.

    Residuals are about a millimeter on a head of 200: true to scale they could not be seen.
    """
    largest = float(registration.residuals_mm.max())
    return next((m for m in (10.0, 5.0, 2.0) if m * largest <= LONGEST_ARROW_MM), 1.0)


def arrowTips(registration: Registration) -> np.ndarray:
    """Return where the arrows end, (n, 3) float, RAS mm."""
    return registration.fixed_mm + magnification(registration) * registration.residual_vectors_mm


def glyphsPolyData(
    registration: Registration, rows: Iterable[int] | None = None
) -> vtk.vtkPolyData:
    """Return a ball on each fiducial and an arrow along its residual, in RAS mm.

    Args:
        registration: whose residuals are shown.
        rows: which of its points; all when left out.

    Its point data hold the residual in mm under the name `residual (mm)`.
    """
    append = vtk.vtkAppendPolyData()
    tips = arrowTips(registration)
    for row in range(len(registration.labels)) if rows is None else rows:
        fixed, residual = registration.fixed_mm[row], float(registration.residuals_mm[row])
        append.AddInputData(_withScalar(_ball(fixed), residual))
        append.AddInputData(_withScalar(_arrow(fixed, tips[row] - fixed), residual))
    append.Update()
    return append.GetOutput()


def showResidualArrows(scene: Any, registration: Registration) -> Any:
    """Show the arrows in a `vtkMRMLModelNode` and return it."""
    node = findOrAddNode(scene, "vtkMRMLModelNode", Role.RESIDUAL_ARROWS, "Residual arrows")
    node.SetAndObservePolyData(glyphsPolyData(registration))
    node.SetDescription(f"Residuals, {magnification(registration):g} times as long")
    showScalars(node, SCALARS, residualRange(registration))
    showLegend(node, "Residual (mm)", ARROWS_RANK)
    return node


def clearResidualArrows(scene: Any) -> None:
    """Leave the arrows' model empty: there is no registration that they could show."""
    node = findNode(scene, "vtkMRMLModelNode", Role.RESIDUAL_ARROWS)
    if node is not None and node.GetPolyData() and node.GetPolyData().GetNumberOfPoints():
        node.SetAndObservePolyData(vtk.vtkPolyData())
        hideLegend(node)


def residualRange(registration: Registration) -> tuple[float, float]:
    """Return the range of the colors, in mm: from 0 to the next whole mm, at least 2."""
    return 0.0, max(2.0, float(np.ceil(registration.residuals_mm.max())))


def _ball(center: np.ndarray) -> vtk.vtkPolyData:
    sphere = vtk.vtkSphereSource()
    sphere.SetCenter(center)
    sphere.SetRadius(2.2)
    sphere.SetThetaResolution(20)
    sphere.SetPhiResolution(20)
    sphere.Update()
    return sphere.GetOutput()


def _arrow(start: np.ndarray, vector: np.ndarray) -> vtk.vtkPolyData:
    """Return an arrow whose shaft has the same thickness whatever its length."""
    length = max(float(np.linalg.norm(vector)), 1e-6)
    arrow = vtk.vtkArrowSource()
    arrow.SetTipResolution(16)
    arrow.SetShaftResolution(12)
    arrow.SetTipLength(min(4.5, 0.5 * length) / length)
    arrow.SetTipRadius(2.0 / length)
    arrow.SetShaftRadius(0.8 / length)
    place = vtk.vtkTransform()
    place.Translate(start)
    place.Concatenate(_turnFromX(vector / length))
    place.Scale(length, length, length)
    placed = vtk.vtkTransformPolyDataFilter()
    placed.SetTransform(place)
    placed.SetInputConnection(arrow.GetOutputPort())
    placed.Update()
    return placed.GetOutput()


def _withScalar(data: vtk.vtkPolyData, value: float) -> vtk.vtkPolyData:
    scalars = vtk.vtkDoubleArray()
    scalars.SetName(SCALARS)
    scalars.SetNumberOfTuples(data.GetNumberOfPoints())
    scalars.Fill(value)
    data.GetPointData().SetScalars(scalars)
    return data


def _turnFromX(direction: np.ndarray) -> vtk.vtkMatrix4x4:
    """Return a rotation that takes the x axis to a unit vector."""
    helper = np.eye(3)[int(np.argmin(np.abs(direction)))]
    across = np.cross(direction, helper)
    across /= np.linalg.norm(across)
    axes = np.column_stack([direction, across, np.cross(direction, across)])
    matrix = vtk.vtkMatrix4x4()
    for row in range(3):
        for column in range(3):
            matrix.SetElement(row, column, axes[row, column])
    return matrix
