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

APART_MM = 0.5
"""Least distance of a vertex to the plane of the cut, which would leave slivers of triangles."""


def surfaceOf(level: np.ndarray, originMm: np.ndarray, spacingMm: float) -> vtk.vtkPolyData:
    """Return the largest closed surface around the positive part of a level set (i, j, k)."""
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
    thin = _output(decimation)
    # Decimation may leave fins: triangles that hang on an edge which two others share.
    openSides = (meshOf(thin).side_uses == 1).sum(axis=1)
    thin.BuildCells()
    for fin in np.flatnonzero(openSides == 2):
        thin.DeleteCell(fin)
    thin.RemoveDeletedCells()
    return thin


def cutFlat(mesh: HeadMesh, heightMm: float) -> HeadMesh:
    """Return what lies above the horizontal plane S = `heightMm`, closed by a flat base.

    Vertices near the plane are first moved away from it. Then every side crosses it properly or not
    at all, and the rim of what is cut off a closed surface is made of simple loops.
    """
    vertices = mesh.vertices.astype(float)
    isAbove = vertices[:, 2] >= heightMm
    isNear = np.abs(vertices[:, 2] - heightMm) < APART_MM
    vertices[isNear, 2] = heightMm + np.where(isAbove, APART_MM, -APART_MM)[isNear]
    countAbove = isAbove[mesh.triangles].sum(axis=1)
    top = _aloneFirst(mesh.triangles[countAbove == 1], isAbove)
    bottom = _aloneFirst(mesh.triangles[countAbove == 2], ~isAbove)
    crossing = np.concatenate([top[:, :2], bottom[:, :2], top[:, ::2], bottom[:, ::2]])
    sides, places = np.unique(np.sort(crossing, axis=1), axis=0, return_inverse=True)
    # Of the sides from a triangle's first corner, to its second one and to its third.
    second, third = (places.ravel() + len(vertices)).reshape(2, -1)
    start, end = vertices[sides[:, 0]], vertices[sides[:, 1]]
    share = (heightMm - start[:, 2:]) / (end[:, 2:] - start[:, 2:])
    cuts = start + share * (end - start)
    cuts[:, 2] = heightMm
    vertices = np.concatenate([vertices, cuts])
    topSecond, bottomSecond = np.split(second, [len(top)])
    topThird, bottomThird = np.split(third, [len(top)])
    rim = np.concatenate(
        [
            np.stack([topThird, topSecond], axis=1),
            np.stack([bottomSecond, bottomThird], axis=1),
        ]
    )
    triangles = np.concatenate(
        [
            mesh.triangles[countAbove == 3],
            np.stack([top[:, 0], topSecond, topThird], axis=1),
            np.stack([bottom[:, 1], bottom[:, 2], bottomSecond], axis=1),
            np.stack([bottom[:, 2], bottomThird, bottomSecond], axis=1),
            _filled(vertices, rim),
        ]
    )
    return _largestPart(vertices, triangles)


def _aloneFirst(triangles: np.ndarray, isAlone: np.ndarray) -> np.ndarray:
    """Return triangles (n, 3), each of which has one corner alone on its side, from that corner."""
    turned = (isAlone[triangles].argmax(axis=1)[:, None] + np.arange(3)) % 3
    return np.take_along_axis(triangles, turned, axis=1)


def _filled(vertices: np.ndarray, rim: np.ndarray) -> np.ndarray:
    """Return triangles (n, 3) that fill the loops of a rim (m, 2), whose sides go around them."""
    following, loops = dict(rim.tolist()), vtk.vtkCellArray()
    while following:
        loop = list(following.popitem())
        while loop[-1] in following:
            loop.append(following.pop(loop[-1]))
        loops.InsertNextCell(len(loop), loop)
    outline = vtk.vtkPolyData()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(vertices, deep=True))
    outline.SetPoints(points)
    outline.SetLines(loops)
    triangulator = vtk.vtkContourTriangulator()
    triangulator.SetInputData(outline)
    triangulator.Update()
    polys = triangulator.GetOutput().GetPolys()
    return vtk_to_numpy(polys.GetConnectivityArray()).reshape(-1, 3)


def _largestPart(vertices: np.ndarray, triangles: np.ndarray) -> HeadMesh:
    """Return the connected part with the most triangles, without unused vertices."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    sides = np.concatenate([triangles[:, :2], triangles[:, 1:]])
    graph = coo_array((np.ones(len(sides)), tuple(sides.T)), shape=(len(vertices),) * 2)
    _, parts = connected_components(graph, directed=False)
    part = parts[triangles[:, 0]]
    used, corners = np.unique(triangles[part == np.bincount(part).argmax()], return_inverse=True)
    return HeadMesh(vertices[used].astype(np.float32), corners.reshape(-1, 3).astype(np.int32))


def meshOf(surface: vtk.vtkPolyData) -> HeadMesh:
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
