"""Take the face out of a head's images, as `head.face_removal` takes it off its surface."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance
from vtkmodules.vtkImagingGeneral import vtkImageEuclideanDistance
from vtkmodules.vtkImagingStencil import vtkImageStencilToImage, vtkPolyDataToImageStencil

from rastrainer import transforms
from rastrainer.head.face_removal import RADIUS_MM, face_vertices, nose_tip, without_face
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.volume import KEPT_MM, HeadVolume
from rastrainer_simulator.scene.surfaces import surface


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
        first = np.array([each.start for each in slices])
        size = tuple(each.stop - each.start for each in slices)
        return Grid(size, self.ijk_to_ras @ transforms.rigid(np.eye(3), first))

    def around(self, center: np.ndarray, radius: float) -> tuple[slice, slice, slice]:
        """Return the part of the image that holds all voxels so near (mm) to a place (3,), RAS."""
        to_ijk = transforms.inverse(self.ijk_to_ras)
        middle = transforms.apply(to_ijk, center)
        reach = radius * np.linalg.norm(to_ijk[:3, :3], axis=1)
        low = np.clip(np.floor(middle - reach), 0, np.array(self.shape) - 1).astype(int)
        high = np.clip(np.ceil(middle + reach) + 1, low + 1, self.shape).astype(int)
        i, j, k = (slice(start, stop) for start, stop in zip(low, high, strict=True))
        return i, j, k

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
        image.SetSpacing(*self.spacing.tolist())
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


LEAST_DEPTH_MM = 15.0
"""So much behind the shield that takes the face's place is taken out, too."""

BEHIND_FACE_MM = 4.0
"""At least so much behind the deepest place of the face, which may lie behind the shield."""

BEYOND_MM = 4.0
"""Around the face's own radius."""

_SAMPLES = 6
"""Along each side of a triangle, whose sides are about two millimeters."""


def without_face_in(volume: HeadVolume, head: HeadMesh) -> HeadVolume:
    """Return the images of a head with nothing in the place of its face, nor around the head.

    What ends there depends on the shield of `without_face`, not on the face: the images tell no
    more about it than the surface that is given with them.

    Args:
        volume: the images.
        head: with its face.
    """
    shield, tip = without_face(head), nose_tip(head)
    grid = Grid(volume.values.shape, volume.ijk_to_ras)
    values, nothing = volume.values.copy(), volume.values.min()
    values[grid.distances(grid.inside(head)) > KEPT_MM] = nothing
    around = grid.around(tip, RADIUS_MM + BEYOND_MM)
    part = grid.part(around)
    is_near = np.linalg.norm(part.places() - tip, axis=-1) < RADIUS_MM + BEYOND_MM
    is_face = face_vertices(head)
    to_shield = part.distances(part.at(_samples(shield, is_face)))
    is_taken = ~part.inside(shield) | (to_shield < _depth(head.vertices[is_face], shield))
    values[around][is_near & is_taken] = nothing
    return replace(volume, values=values)


def _samples(mesh: HeadMesh, is_wanted: np.ndarray) -> np.ndarray:
    """Return places (n, 3), RAS mm, all over the triangles that have a wanted corner."""
    corners = mesh.vertices[mesh.triangles[is_wanted[mesh.triangles].any(axis=1)]]
    steps = np.arange(_SAMPLES + 1) / _SAMPLES
    weights = np.array([(a, b, 1.0 - a - b) for a in steps for b in steps if a + b < 1.0 + 1e-9])
    return np.einsum("wc,tcx->wtx", weights, corners).reshape(-1, 3)


def _depth(face: np.ndarray, shield: HeadMesh) -> float:
    """Return how much behind the shield (mm) no place (n, 3) of the face is left."""
    signed = vtkImplicitPolyDataDistance()
    signed.SetInput(surface(shield.vertices, shield.triangles))
    deepest = max((-signed.EvaluateFunction(place) for place in face.astype(float)), default=0.0)
    return max(LEAST_DEPTH_MM, deepest + BEHIND_FACE_MM)
