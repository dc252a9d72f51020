"""A volume as the head's extraction wants it: an array and where it lies in the patient."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.slicer.head.cut_files import is_cut_nifti

if TYPE_CHECKING:
    import slicer


@dataclass(frozen=True)
class Volume:
    """A scalar image.

    Attributes:
        values: (i, j, k) float.
        ijk_to_ras: (4, 4) float, maps voxel indices to patient coordinates, mm.
    """

    values: np.ndarray
    ijk_to_ras: np.ndarray


def volume_from_node(node: slicer.vtkMRMLScalarVolumeNode) -> Volume:
    """Return the image of a volume node where its transforms place it; see `image_of_node`."""
    return as_float(image_of_node(node))


def image_of_node(node: slicer.vtkMRMLScalarVolumeNode) -> Volume:
    """Return the image of a volume node where its transforms place it, at once: it is not copied.

    Its values are of the node's own type; `as_float` copies them, in any thread.

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
    return Volume(values, to_world(node) @ matrix_of(matrix))


def as_float(volume: Volume) -> Volume:
    """Return a volume of its own whose values are of type float32."""
    return Volume(volume.values.astype(np.float32), volume.ijk_to_ras)


def to_world(node: slicer.vtkMRMLTransformableNode) -> np.ndarray:
    """Return the (4, 4) matrix, mm, of the transforms that a node stands under.

    Raises:
        InputError: they are not linear.
    """
    parent, matrix = node.GetParentTransformNode(), vtk.vtkMatrix4x4()
    if parent is not None:
        if not parent.IsTransformToWorldLinear():
            raise InputError(
                f"{node.GetName()} stands under the transform {parent.GetName()}, which is not "
                "linear: harden it, or take it off."
            )
        parent.GetMatrixTransformToWorld(matrix)
    return matrix_of(matrix)


def matrix_of(matrix: vtk.vtkMatrix4x4) -> np.ndarray:
    """Return VTK's matrix as (4, 4) float."""
    return np.array([[matrix.GetElement(row, column) for column in range(4)] for row in range(4)])


def read_volume(path: Path) -> Volume:
    """Read a volume of any format that Slicer's volume reader knows, such as NRRD or NIfTI.

    Raises:
        InputError: the file is missing or is no such volume.
    """
    if not Path(path).is_file():
        raise InputError(f"{path} does not exist; give a volume such as a .nii.gz or .nrrd file.")
    if str(path).endswith((".nii", ".nii.gz")) and is_cut_nifti(path):
        raise InputError(f"{path} is cut short; copy the file again.")
    # Only here: the process that makes heads does without MRML.
    import slicer

    scene = slicer.vtkMRMLScene()
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    storage = slicer.vtkMRMLVolumeArchetypeStorageNode()
    storage.SetFileName(str(path))
    if not storage.ReadData(node) or node.GetImageData() is None:
        raise InputError(f"{path} could not be read as a volume such as NIfTI or NRRD.")
    return volume_from_node(node)


def on_ras_grid(volume: Volume, spacing_mm: float) -> Volume:
    """Return the volume on a cubic grid whose axes run to the right, anterior and superior.

    The grid of an oblique volume begins at the middle of its lowest slice, which is repeated below,
    so that the neck goes on to a flat base; what else the volume does not cover is air.
    """
    indices = np.array(np.meshgrid(*[(0, n - 1) for n in volume.values.shape])).reshape(3, -1).T
    corners = indices @ volume.ijk_to_ras[:3, :3].T + volume.ijk_to_ras[:3, 3]
    axis, end = lowest_slice(volume)
    heights = corners[indices[:, axis] == end, 2]
    origin, top = corners.min(axis=0), corners.max(axis=0)
    origin[2] = heights.mean()
    grid_to_ras = np.diag([spacing_mm] * 3 + [1.0])
    grid_to_ras[:3, 3] = origin
    volume = _repeated(volume, axis, end, float(np.ptp(heights)))
    shape = tuple(int(n) for n in np.floor((top - origin) / spacing_mm + 1e-6) + 1)
    return Volume(sampled(volume, grid_to_ras, shape), grid_to_ras)


def sampled(volume: Volume, grid_to_ras: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Return a volume's values (i, j, k) float at the places of a grid, linearly interpolated.

    What the volume does not cover is taken for air, its lowest value: 0 HU would be tissue.
    """
    # Only here: scipy takes time to import.
    from scipy import ndimage

    grid_to_ijk = np.linalg.inv(volume.ijk_to_ras) @ grid_to_ras
    return ndimage.affine_transform(
        volume.values,
        grid_to_ijk[:3, :3],
        grid_to_ijk[:3, 3],
        shape,
        order=1,
        cval=float(volume.values.min()),
    )


def lowest_slice(volume: Volume) -> tuple[int, int]:
    """Return the axis that is nearest to the vertical, and the index of its lower end."""
    axis = int(np.abs(volume.ijk_to_ras[2, :3]).argmax())
    return axis, 0 if volume.ijk_to_ras[2, axis] > 0 else volume.values.shape[axis] - 1


def _repeated(volume: Volume, axis: int, end: int, down_mm: float) -> Volume:
    """Return the volume with the slice at one end repeated for so much of height."""
    count = int(np.ceil(down_mm / abs(volume.ijk_to_ras[2, axis]) - 1e-6))
    widths = [(0, 0)] * 3
    widths[axis] = (count, 0) if end == 0 else (0, count)
    matrix = volume.ijk_to_ras.copy()
    matrix[:3, 3] -= widths[axis][0] * matrix[:3, axis]
    return Volume(np.pad(volume.values, widths, mode="edge"), matrix)
