"""The numbers of a registration as table nodes, with the unit in each column's name."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import vtk

from rastrainer.registration import Registration
from rastrainer.slicer.scene import Role, findOrAddNode
from rastrainer.target_error import TargetError


@dataclass(frozen=True)
class Column:
    """One column of a table: texts or numbers."""

    name: str
    values: Sequence[str] | Sequence[float]


def showResiduals(scene: Any, registration: Registration) -> Any:
    """Show the residual of each fiducial in a `vtkMRMLTableNode` and return it."""
    vectors = registration.residual_vectors_mm
    return _show(
        scene,
        Role.RESIDUALS,
        "Residuals",
        [
            Column("fiducial", registration.labels),
            Column("residual (mm)", registration.residuals_mm),
            Column("residual R (mm)", vectors[:, 0]),
            Column("residual A (mm)", vectors[:, 1]),
            Column("residual S (mm)", vectors[:, 2]),
        ],
    )


def showFits(scene: Any, fits: Sequence[Registration], targetErrors: Sequence[TargetError]) -> Any:
    """Compare fits of the same points in a `vtkMRMLTableNode` and return it.

    Args:
        scene: the scene.
        fits: one a row.
        targetErrors: of each fit, what to expect at the target.
    """
    ends = [error.interval_mm for error in targetErrors]
    return _show(
        scene,
        Role.FITS,
        "Fits",
        [
            Column("fit", [fit.kind for fit in fits]),
            Column("FRE (mm)", [fit.fre_mm for fit in fits]),
            Column("largest residual (mm)", [fit.residuals_mm.max() for fit in fits]),
            Column("expected TRE (mm)", [error.expected_mm for error in targetErrors]),
            Column("TRE from, 95 % (mm)", [low for low, _high in ends]),
            Column("TRE to, 95 % (mm)", [high for _low, high in ends]),
        ],
    )


def _show(scene: Any, role: str, name: str, columns: Sequence[Column]) -> Any:
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
    isText = isinstance(column.values[0], str)
    array = vtk.vtkStringArray() if isText else vtk.vtkDoubleArray()
    array.SetName(column.name)
    for value in column.values:
        array.InsertNextValue(value if isText else float(value))
    return array
