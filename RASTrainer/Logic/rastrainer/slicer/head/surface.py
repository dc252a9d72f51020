"""Makes a closed surface with a flat base out of a level set, by VTK's filters."""

from __future__ import annotations

from typing import Any

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.slicer.polydata import trianglesPolyData, vtkArray

SMOOTHING_PASS_BAND = 0.08
"""Pass band of the windowed-sinc filter (Taubin 1996): removes the grid's steps, keeps eyelids and
ears."""

SMOOTHING_ITERATIONS = 30

APART_MM = 0.5
"""Least distance of a vertex to the plane of the cut, which would leave slivers of triangles."""


def surfaceOf(level: np.ndarray, originMm: np.ndarray, spacingMm: float) -> vtk.vtkPolyData:
    """Return the largest closed surface around the positive part of a level set (i, j, k)."""
    padded = np.pad(level, 1, constant_values=-1.0)
    origin = np.asarray(originMm) - spacingMm
    image = vtk.vtkImageData(dimensions=padded.shape, spacing=[spacingMm] * 3, origin=origin)
    image.GetPointData().SetScalars(vtkArray(padded.astype(np.float32).ravel(order="F")))
    contour = vtk.vtkFlyingEdges3D(compute_normals=False, compute_scalars=False)
    contour.SetValue(0, 0.0)
    return _output(image >> contour >> _largestPart())


def smoothed(surface: vtk.vtkPolyData) -> vtk.vtkPolyData:
    """Return the surface without the steps of its grid, and without shrinking it."""
    smoother = vtk.vtkWindowedSincPolyDataFilter(
        number_of_iterations=SMOOTHING_ITERATIONS,
        pass_band=SMOOTHING_PASS_BAND,
        normalize_coordinates=True,
        feature_edge_smoothing=False,
    )
    return _output(surface >> smoother)


def decimated(surface: vtk.vtkPolyData, triangleCount: int, aboveMm: float) -> vtk.vtkPolyData:
    """Return the surface with at most about `triangleCount` triangles above a height."""
    mesh = meshOf(surface)
    countAbove = np.count_nonzero(mesh.vertices[mesh.triangles[:, 0], 2] > aboveMm)
    if countAbove <= triangleCount:
        return surface
    reduction = 1.0 - triangleCount / countAbove
    thin = _output(surface >> vtk.vtkQuadricDecimation(target_reduction=reduction))
    # Decimation may leave fins: triangles that hang on an edge which two others share.
    openSides = (meshOf(thin).side_uses == 1).sum(axis=1)
    thin.BuildCells()
    for fin in np.flatnonzero(openSides == 2):
        thin.DeleteCell(fin)
    thin.RemoveDeletedCells()
    return thin


def cutFlat(mesh: HeadMesh, heightMm: float) -> HeadMesh:
    """Return the largest part above the horizontal plane S = `heightMm`, closed by a flat base.

    Vertices near the plane are first moved away from it: the cut would leave slivers of triangles.
    """
    vertices = mesh.vertices.astype(float)
    isNear = np.abs(vertices[:, 2] - heightMm) < APART_MM
    isAbove = vertices[:, 2] >= heightMm
    vertices[isNear, 2] = heightMm + np.where(isAbove, APART_MM, -APART_MM)[isNear]
    planes = vtk.vtkPlaneCollection()
    planes.AddItem(vtk.vtkPlane(origin=(0.0, 0.0, heightMm), normal=(0.0, 0.0, 1.0)))
    clip = vtk.vtkClipClosedSurface(clipping_planes=planes, tolerance=1e-12)
    clean = vtk.vtkCleanPolyData(point_merging=False)
    whole = trianglesPolyData(vertices, mesh.triangles)
    return meshOf(_output(whole >> clip >> vtk.vtkTriangleFilter() >> _largestPart() >> clean))


def meshOf(surface: vtk.vtkPolyData) -> HeadMesh:
    return HeadMesh(
        vtk_to_numpy(surface.GetPoints().GetData()).astype(np.float32),
        vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3).astype(np.int32),
    )


def _largestPart() -> vtk.vtkPolyDataConnectivityFilter:
    largest = vtk.vtkPolyDataConnectivityFilter()
    largest.SetExtractionModeToLargestRegion()
    return largest


def _output(filters: Any) -> vtk.vtkPolyData:
    """Return what a pipeline of filters makes."""
    surface = filters.update().output
    if surface.GetNumberOfPolys() == 0:
        raise InputError("No head was found: there is no surface at the threshold.")
    return surface
