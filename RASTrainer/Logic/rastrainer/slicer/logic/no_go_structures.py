"""Closed surfaces of models and segments that no instrument may touch."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import vtk

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.procedure.plan import check_no_go_mesh, check_no_go_size
from rastrainer.slicer.translation import _


def noGoMeshes(nodes: list[Any]) -> dict[str, HeadMesh]:
    """Return the surfaces of no-go structures by name, RAS mm.

    Args:
        nodes: `vtkMRMLModelNode` or `vtkMRMLSegmentationNode`, of which each segment is one.

    Raises:
        InputError: one is empty, open or too large, two have one name, or a transform is not
            linear.
    """
    found: dict[str, HeadMesh] = {}
    for node in nodes:
        for name, surface in _surfaces(node):
            if name in found:
                text = _("Two no-go structures are named {name}: give each its own name.")
                raise InputError(text.format(name=name))
            found[name] = _mesh(name, surface, node)
    return found


def _surfaces(node: Any) -> Iterator[tuple[str, vtk.vtkPolyData]]:
    if node.IsA("vtkMRMLModelNode"):
        yield node.GetName(), node.GetPolyData()
        return
    segmentation = node.GetSegmentation()
    node.CreateClosedSurfaceRepresentation()
    for segmentId in segmentation.GetSegmentIDs():
        surface = vtk.vtkPolyData()
        node.GetClosedSurfaceRepresentation(segmentId, surface)
        yield segmentation.GetSegment(segmentId).GetName(), surface


def _mesh(name: str, surface: vtk.vtkPolyData | None, node: Any) -> HeadMesh:
    from rastrainer.slicer.head.surface import meshOf
    from rastrainer.slicer.head.volume import toWorld

    if surface is None or surface.GetNumberOfPolys() == 0:
        raise InputError(_("The no-go structure {name} is empty.").format(name=name))
    # Before anything takes long.
    check_no_go_size(surface.GetNumberOfPolys(), name)
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputData(surface)
    triangles.PassLinesOff()
    triangles.PassVertsOff()
    merged = vtk.vtkCleanPolyData()
    merged.SetInputConnection(triangles.GetOutputPort())
    merged.Update()
    mesh = meshOf(merged.GetOutput())
    placed = HeadMesh(transforms.apply(toWorld(node), mesh.vertices), mesh.triangles)
    check_no_go_mesh(placed, name)
    return placed
