"""Numbers and texts as table nodes, with the unit in each column's name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import vtk

from rastrainer.registration.registration import Registration
from rastrainer.registration.target_error import TargetError
from rastrainer.slicer.scene.scene import Role, findOrAddNode


@dataclass(frozen=True)
class Column:
    """One column of a table: texts, or numbers where None is unknown."""

    name: str
    values: Sequence[str] | Sequence[float | None] | np.ndarray
    isText: bool = False


def showTable(scene: Any, role: str, name: str, columns: Sequence[Column]) -> Any:
    """Put columns into the `vtkMRMLTableNode` of a role and return it."""
    node = findOrAddNode(scene, "vtkMRMLTableNode", role, name)
    wasModifying = node.StartModify()
    node.RemoveAllColumns()
    node.SetUseColumnTitleAsColumnHeader(True)
    for column in columns:
        node.AddColumn(_array(column))
    node.SetLocked(True)
    node.EndModify(wasModifying)
    return node


def _array(column: Column) -> vtk.vtkAbstractArray:
    array = vtk.vtkStringArray() if column.isText else vtk.vtkDoubleArray()
    array.SetName(column.name)
    for value in column.values:
        array.InsertNextValue(value if column.isText else math.nan if value is None else value)
    return array


def showResiduals(
    scene: Any, registration: Registration, leaveOneOut: np.ndarray | None = None
) -> Any:
    """Show the residual of each fiducial in a `vtkMRMLTableNode` and return it.

    Args:
        scene: the scene.
        registration: whose residuals are shown.
        leaveOneOut: (n,) float, mm, how far each touch lies from where the other pairs put it;
            None where there are too few pairs.
    """
    vectors = registration.residual_vectors_mm
    leftOut = [None] * len(registration.labels) if leaveOneOut is None else leaveOneOut
    return showTable(
        scene,
        Role.RESIDUALS,
        "Residuals",
        [
            Column("fiducial", registration.labels, isText=True),
            Column("residual (mm)", registration.residuals_mm),
            Column("residual R (mm)", vectors[:, 0]),
            Column("residual A (mm)", vectors[:, 1]),
            Column("residual S (mm)", vectors[:, 2]),
            Column("without it (mm)", leftOut),
        ],
    )


def showFits(
    scene: Any, fits: Sequence[Registration], targetErrors: Sequence[TargetError | None]
) -> Any:
    """Compare fits of the same points in a `vtkMRMLTableNode` and return it.

    Args:
        scene: the scene.
        fits: one a row.
        targetErrors: of each fit, what to expect at the target; None where it is not known.
    """
    known = [(e.expected_mm, *e.interval_mm) if e else (None, None, None) for e in targetErrors]
    return showTable(
        scene,
        Role.FITS,
        "Fits",
        [
            Column("fit", [fit.kind for fit in fits], isText=True),
            Column("FRE (mm)", [fit.fre_mm for fit in fits]),
            Column("largest residual (mm)", [fit.residuals_mm.max() for fit in fits]),
            Column("expected TRE (mm)", [expected for expected, _low, _high in known]),
            Column("TRE from, 95 % (mm)", [low for _expected, low, _high in known]),
            Column("TRE to, 95 % (mm)", [high for _expected, _low, high in known]),
        ],
    )
