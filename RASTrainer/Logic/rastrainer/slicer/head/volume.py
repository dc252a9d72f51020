"""A volume as the head's extraction wants it, and the head that is found in it, as voxels."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.errors import InputError

if TYPE_CHECKING:
    import slicer


@dataclass(frozen=True)
class Volume:
    """A scalar image.

    Attributes:
        values: (i, j, k) float.
        ijkToRas: (4, 4) float, maps voxel indices to patient coordinates, mm.
    """

    values: np.ndarray
    ijkToRas: np.ndarray


def volumeFromNode(node: slicer.vtkMRMLScalarVolumeNode) -> Volume:
    """Return the image of a volume node where its transforms place it; see `imageOfNode`."""
    return asFloat(imageOfNode(node))


def imageOfNode(node: slicer.vtkMRMLScalarVolumeNode) -> Volume:
    """Return the image of a volume node where its transforms place it, at once: it is not copied.

    Its values are of the node's own type; `asFloat` copies them, in any thread.

    Raises:
        InputError: it has none, or one with colors, or its transform is not linear.
    """
    image = node.GetImageData()
    if image is None:
        raise InputError(f"The volume {node.GetName()} holds no image.")
    matrix = vtk.vtkMatrix4x4()
    node.GetIJKToRASMatrix(matrix)
    array = image.GetPointData().GetScalars()
    if array is None or array.GetNumberOfComponents() != 1:
        raise InputError("The volume must have one value a voxel, not none and not a color.")
    values = vtk_to_numpy(array).reshape(image.GetDimensions()[::-1]).transpose(2, 1, 0)
    return Volume(values, toWorld(node) @ matrixOf(matrix))


def asFloat(volume: Volume) -> Volume:
    """Return a copy of a volume with values of type float32."""
    return Volume(volume.values.astype(np.float32), volume.ijkToRas)


def toWorld(node: slicer.vtkMRMLTransformableNode) -> np.ndarray:
    """Return the (4, 4) matrix, mm, of a node's parent transforms.

    Raises:
        InputError: they are not linear.
    """
    parent, matrix = node.GetParentTransformNode(), vtk.vtkMatrix4x4()
    if parent is not None:
        if not parent.IsTransformToWorldLinear():
            raise InputError(
                f"{node.GetName()} has the parent transform {parent.GetName()}, which is not "
                "linear: harden it or remove it."
            )
        parent.GetMatrixTransformToWorld(matrix)
    return matrixOf(matrix)


def matrixOf(matrix: vtk.vtkMatrix4x4) -> np.ndarray:
    """Return VTK's matrix as (4, 4) float."""
    return np.array([[matrix.GetElement(row, column) for column in range(4)] for row in range(4)])


def onRasGrid(volume: Volume, spacingMm: float) -> Volume:
    """Return the volume on a cubic grid whose axes run to the right, anterior and superior.

    The grid of an oblique volume begins at the middle of its lowest slice, which is repeated below,
    so that the neck continues to a flat base; what else the volume does not cover is air.
    """
    indices = np.array(np.meshgrid(*[(0, n - 1) for n in volume.values.shape])).reshape(3, -1).T
    corners = indices @ volume.ijkToRas[:3, :3].T + volume.ijkToRas[:3, 3]
    axis, end = lowestSlice(volume)
    heights = corners[indices[:, axis] == end, 2]
    origin, top = corners.min(axis=0), corners.max(axis=0)
    origin[2] = heights.mean()
    gridToRas = np.diag([spacingMm] * 3 + [1.0])
    gridToRas[:3, 3] = origin
    volume = _repeated(volume, axis, end, float(np.ptp(heights)))
    shape = tuple(int(n) for n in np.floor((top - origin) / spacingMm + 1e-6) + 1)
    return Volume(sampled(volume, gridToRas, shape), gridToRas)


def sampled(volume: Volume, gridToRas: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Return a volume's values (i, j, k) float at the places of a grid, linearly interpolated.

    What the volume does not cover is taken for air, its lowest value: 0 HU would be tissue.
    """
    # Only here: scipy takes time to import.
    from scipy import ndimage

    gridToIjk = np.linalg.inv(volume.ijkToRas) @ gridToRas
    return ndimage.affine_transform(
        volume.values,
        gridToIjk[:3, :3],
        gridToIjk[:3, 3],
        shape,
        order=1,
        cval=float(volume.values.min()),
    )


def lowestSlice(volume: Volume) -> tuple[int, int]:
    """Return the axis that is nearest to the vertical, and the index of its lower end."""
    axis = int(np.abs(volume.ijkToRas[2, :3]).argmax())
    return axis, 0 if volume.ijkToRas[2, axis] > 0 else volume.values.shape[axis] - 1


def _repeated(volume: Volume, axis: int, end: int, downMm: float) -> Volume:
    """Return the volume with the slice at one end repeated over a height."""
    count = int(np.ceil(downMm / abs(volume.ijkToRas[2, axis]) - 1e-6))
    widths = [(0, 0)] * 3
    widths[axis] = (count, 0) if end == 0 else (0, count)
    matrix = volume.ijkToRas.copy()
    matrix[:3, 3] -= widths[axis][0] * matrix[:3, axis]
    return Volume(np.pad(volume.values, widths, mode="edge"), matrix)


SPACING_MM = 1.0
"""Of the voxels."""
BELOW_BASE_MM = 3.0
"""How far a segment continues below the base, so that its end does not affect the cut."""


@dataclass(frozen=True)
class HeadSettings:
    """What may be chosen about the extraction.

    Attributes:
        threshold: value that parts air from skin; None finds it (Otsu; −475 HU of a CT).
        baseMm: height (S) of the flat base; None for just above the image's lower edge, or the
            neck.
        noiseMm: standard deviation of the smoothing of the image.
        cavityDepthMm: what lies so deep below the skin is filled: airways, sinuses, ear canals.
        openingMm: openings up to this width do not count as part of the skin's outside.
        triangles: how many are aimed at; the flat base adds a few.
    """

    threshold: float | None = None
    baseMm: float | None = None
    noiseMm: float = 1.0
    cavityDepthMm: float = 4.0
    openingMm: float = 12.0
    triangles: int = 55_000


@dataclass(frozen=True)
class HeadBody:
    """A head as voxels of 1 mm along RAS, before it becomes a surface.

    Attributes:
        level: (i, j, k) float, positive inside, its zero between the voxels where the skin is.
        body: (i, j, k) bool, without cavities and tunnels.
        origin: (3,) float, RAS mm, of voxel 0, 0, 0.
        baseMm: height (S) of the flat base.
        threshold: that parts air from skin, in the volume's own values.
        isCt: whether the values are Hounsfield units.
    """

    level: np.ndarray
    body: np.ndarray
    origin: np.ndarray
    baseMm: float
    threshold: float
    isCt: bool

    @cached_property
    def labels(self) -> tuple[np.ndarray, np.ndarray]:
        """The body as a segment has it, and where its first voxel is.

        (k, j, i) uint8, 1 inside, down to 3 mm below the base; (3,) float, RAS mm. Made once, which
        takes a moment.
        """
        below = max(0, round((self.baseMm - BELOW_BASE_MM - self.origin[2]) / SPACING_MM))
        voxels = np.ascontiguousarray(self.body[:, :, below:].transpose(2, 1, 0), np.uint8)
        return voxels, self.origin + np.array([0.0, 0.0, below * SPACING_MM])
