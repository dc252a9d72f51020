"""The head colored by the target error to expect at each place of it."""

from __future__ import annotations

from typing import Any

import numpy as np
import slicer
import vtk
from vtk.util.numpy_support import numpy_to_vtk

from rastrainer.localization_error import LocalizationError
from rastrainer.registration import Registration
from rastrainer.slicer.color_legend import HEAD_RANK, hideLegend, showLegend
from rastrainer.slicer.residual_glyphs import COLOR_TABLE_ID
from rastrainer.target_error import expected_tre

SCALARS = "expected TRE (mm)"


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
    display = model.GetDisplayNode()
    display.SetActiveScalar(SCALARS, vtk.vtkAssignAttribute.POINT_DATA)
    display.SetAndObserveColorNodeID(COLOR_TABLE_ID)
    display.SetScalarRangeFlag(display.UseManualScalarRange)
    low, high = float(errors.min()), float(errors.max())
    display.SetScalarRange(*colorRange(low, high))
    display.SetScalarVisibility(True)
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
