"""Numbers and texts as table nodes, with the unit in each column's name."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import vtk

from rastrainer.slicer.scene import findOrAddNode


@dataclass(frozen=True)
class Column:
    """One column of a table: texts, or numbers where None is unknown."""

    name: str
    values: Sequence[str] | Sequence[float | None]
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
