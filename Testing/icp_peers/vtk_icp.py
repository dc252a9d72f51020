"""VTK's ICP, as a peer of the surface match."""

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

from rastrainer import transforms


def vtk_match(trace, mesh, start):
    """VTK's ICP: true nearest points of cells, all points count, point to point."""
    surface, points, cells = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    points.SetData(numpy_to_vtk(mesh.vertices, deep=True))
    corners = mesh.triangles.astype(np.int64).ravel()
    offsets = np.arange(0, corners.size + 1, 3)
    cells.SetData(*(numpy_to_vtkIdTypeArray(each, deep=True) for each in (offsets, corners)))
    surface.SetPoints(points)
    surface.SetPolys(cells)
    source, places_ = vtk.vtkPolyData(), vtk.vtkPoints()
    places_.SetData(numpy_to_vtk(transforms.apply(start, trace), deep=True))
    source.SetPoints(places_)
    icp = vtk.vtkIterativeClosestPointTransform()
    icp.SetSource(source)
    icp.SetTarget(surface)
    icp.GetLandmarkTransform().SetModeToRigidBody()
    icp.SetMaximumNumberOfLandmarks(len(trace))
    icp.SetMaximumNumberOfIterations(2000)
    icp.SetCheckMeanDistance(True)
    icp.SetMaximumMeanDistance(1e-9)
    icp.Update()
    matrix = np.array([[icp.GetMatrix().GetElement(i, j) for j in range(4)] for i in range(4)])
    return matrix @ start
