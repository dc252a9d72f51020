"""From a level set to a closed surface with a flat base: VTK's filters, one after the other."""

from __future__ import annotations

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh

SMOOTHING_PASS_BAND = 0.08
"""Of the windowed-sinc filter (Taubin 1996): removes the grid's steps, keeps eyelids and ears."""

SMOOTHING_ITERATIONS = 30

SNAP_MM = 0.5
"""Vertices so near to the base are moved onto it: the cut would leave slivers of triangles."""


def surfaceOf(level: np.ndarray, originMm: np.ndarray, spacingMm: float) -> vtk.vtkPolyData:
    """Return the largest closed surface around the positive part of a level set.

    Args:
        level: (i, j, k) float, positive inside, on a grid along the axes of RAS.
        originMm: (3,) float, RAS position of voxel 0, 0, 0.
        spacingMm: of the grid.
    """
    padded = np.pad(level, 1, constant_values=-1.0)
    image = vtk.vtkImageData()
    image.SetDimensions(padded.shape)
    image.SetSpacing([spacingMm] * 3)
    image.SetOrigin(np.asarray(originMm) - spacingMm)
    scalars = np.ascontiguousarray(padded.transpose(2, 1, 0), np.float32).ravel()
    image.GetPointData().SetScalars(numpy_to_vtk(scalars, deep=True))
    contour = vtk.vtkFlyingEdges3D()
    contour.SetInputData(image)
    contour.SetValue(0, 0.0)
    contour.ComputeNormalsOff()
    contour.ComputeScalarsOff()
    largest = vtk.vtkPolyDataConnectivityFilter()
    largest.SetInputConnection(contour.GetOutputPort())
    largest.SetExtractionModeToLargestRegion()
    return _output(largest)


def smoothed(surface: vtk.vtkPolyData) -> vtk.vtkPolyData:
    """Return the surface without the steps of its grid, and without shrinking it."""
    smoother = vtk.vtkWindowedSincPolyDataFilter()
    smoother.SetInputData(surface)
    smoother.SetNumberOfIterations(SMOOTHING_ITERATIONS)
    smoother.SetPassBand(SMOOTHING_PASS_BAND)
    smoother.NormalizeCoordinatesOn()
    smoother.FeatureEdgeSmoothingOff()
    return _output(smoother)


def decimated(surface: vtk.vtkPolyData, triangleCount: int, aboveMm: float) -> vtk.vtkPolyData:
    """Return the surface with at most about `triangleCount` triangles above a height."""
    mesh = meshOf(surface)
    countAbove = np.count_nonzero(mesh.vertices[mesh.triangles[:, 0], 2] > aboveMm)
    if countAbove <= triangleCount:
        return surface
    decimation = vtk.vtkQuadricDecimation()
    decimation.SetInputData(surface)
    decimation.SetTargetReduction(1.0 - triangleCount / countAbove)
    return _withoutFins(_output(decimation))


def _withoutFins(surface: vtk.vtkPolyData) -> vtk.vtkPolyData:
    """Remove triangles that hang on an edge which two others share: decimation may leave some."""
    openSides = (meshOf(surface).side_uses == 1).sum(axis=1)
    surface.BuildCells()
    for fin in np.flatnonzero(openSides == 2):
        surface.DeleteCell(fin)
    surface.RemoveDeletedCells()
    return surface


def cutFlat(surface: vtk.vtkPolyData, heightMm: float) -> vtk.vtkPolyData:
    """Return what lies above the horizontal plane S = `heightMm`, closed by a flat base."""
    snapped = vtk.vtkPolyData()
    snapped.DeepCopy(surface)
    heights = vtk_to_numpy(snapped.GetPoints().GetData())[:, 2]
    heights[np.abs(heights - heightMm) < SNAP_MM] = heightMm
    plane = vtk.vtkPlane()
    plane.SetOrigin(0.0, 0.0, heightMm)
    plane.SetNormal(0.0, 0.0, 1.0)
    planes = vtk.vtkPlaneCollection()
    planes.AddItem(plane)
    clip = vtk.vtkClipClosedSurface()
    clip.SetInputData(snapped)
    clip.SetClippingPlanes(planes)
    triangles = vtk.vtkTriangleFilter()
    triangles.SetInputConnection(clip.GetOutputPort())
    merged = vtk.vtkCleanPolyData()
    merged.SetInputConnection(triangles.GetOutputPort())
    merged.ToleranceIsAbsoluteOn()
    merged.SetAbsoluteTolerance(1e-3)
    return _output(merged)


def meshOf(surface: vtk.vtkPolyData) -> HeadMesh:
    """Return the surface's vertices and triangles."""
    return HeadMesh(
        vtk_to_numpy(surface.GetPoints().GetData()).astype(np.float32),
        vtk_to_numpy(surface.GetPolys().GetConnectivityArray()).reshape(-1, 3).astype(np.int32),
    )


def _output(filter_: vtk.vtkPolyDataAlgorithm) -> vtk.vtkPolyData:
    filter_.Update()
    surface = filter_.GetOutput()
    if surface.GetNumberOfPolys() == 0:
        raise InputError("No head was found: there is no surface at the threshold.")
    return surface
