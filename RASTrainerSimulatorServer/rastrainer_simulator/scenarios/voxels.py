"""Which voxels of an image lie in a surface or on it, and how far the others are from them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkImagingGeneral import vtkImageEuclideanDistance
from vtkmodules.vtkImagingStencil import vtkImageStencilToImage, vtkPolyDataToImageStencil

from rastrainer import transforms
from rastrainer.head_mesh import HeadMesh
from rastrainer_simulator.views.actors import surface


@dataclass(frozen=True)
class Grid:
    """Where voxels lie.

    Attributes:
        shape: how many there are along each axis.
        ijk_to_ras: (4, 4) float, mm.
    """

    shape: tuple[int, int, int]
    ijk_to_ras: np.ndarray

    @property
    def spacing(self) -> np.ndarray:
        """(3,) float: the voxels' size along each axis, mm."""
        return np.linalg.norm(self.ijk_to_ras[:3, :3], axis=0)

    def part(self, slices: tuple[slice, slice, slice]) -> Grid:
        """Return the grid of a part of the image."""
        first = [each.start for each in slices]
        size = tuple(each.stop - each.start for each in slices)
        return Grid(size, self.ijk_to_ras @ transforms.rigid(np.eye(3), first))

    def around(self, center: np.ndarray, radius: float) -> tuple[slice, slice, slice]:
        """Return the part of the image that holds all voxels so near (mm) to a place (3,), RAS."""
        to_ijk = transforms.inverse(self.ijk_to_ras)
        middle = transforms.apply(to_ijk, center)
        reach = radius * np.linalg.norm(to_ijk[:3, :3], axis=1)
        low = np.clip(np.floor(middle - reach), 0, np.array(self.shape) - 1).astype(int)
        high = np.clip(np.ceil(middle + reach) + 1, low + 1, self.shape).astype(int)
        return tuple(slice(start, stop) for start, stop in zip(low, high, strict=True))

    def places(self) -> np.ndarray:
        """Return the middle of each voxel, (i, j, k, 3) float, RAS mm."""
        return transforms.apply(self.ijk_to_ras, np.moveaxis(np.indices(self.shape), 0, -1))

    def inside(self, mesh: HeadMesh) -> np.ndarray:
        """Return which voxels (i, j, k) bool lie within a closed surface."""
        vertices = transforms.apply(transforms.inverse(self.ijk_to_ras), mesh.vertices)
        stencil = vtkPolyDataToImageStencil()
        stencil.SetInputData(surface(vertices, mesh.triangles))
        stencil.SetOutputWholeExtent(*_extent(self.shape))
        image = vtkImageStencilToImage()
        image.SetInputConnection(stencil.GetOutputPort())
        image.SetOutputScalarTypeToUnsignedChar()
        image.Update()
        return _array(image.GetOutput()) > 0

    def at(self, places: np.ndarray) -> np.ndarray:
        """Return which voxels (i, j, k) bool hold one of the places (n, 3), RAS mm."""
        indices = np.rint(transforms.apply(transforms.inverse(self.ijk_to_ras), places)).astype(int)
        indices = indices[((indices >= 0) & (indices < self.shape)).all(axis=1)]
        marked = np.zeros(self.shape, dtype=bool)
        marked[tuple(indices.T)] = True
        return marked

    def distances(self, marked: np.ndarray) -> np.ndarray:
        """Return how far (i, j, k) float, mm, each voxel is from the nearest marked one."""
        image = vtkImageData()
        image.SetDimensions(self.shape)
        image.SetSpacing(self.spacing)
        unmarked = np.asarray(~marked, np.uint8).ravel(order="F")
        image.GetPointData().SetScalars(numpy_to_vtk(unmarked, deep=True))
        squared = vtkImageEuclideanDistance()
        squared.SetInputData(image)
        squared.Update()
        return np.sqrt(_array(squared.GetOutput()))


def _extent(shape: tuple[int, int, int]) -> list[int]:
    return [end for size in shape for end in (0, size - 1)]


def _array(image: vtkImageData) -> np.ndarray:
    scalars = vtk_to_numpy(image.GetPointData().GetScalars())
    return scalars.reshape(image.GetDimensions(), order="F")
