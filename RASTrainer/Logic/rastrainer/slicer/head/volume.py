"""Volumes and segments of the scene as arrays, and the head found in them, as voxels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.slicer.head.volume_header import missingOrientation

if TYPE_CHECKING:
    import slicer


@dataclass(frozen=True)
class Volume:
    """A scalar image (i, j, k), its place in the patient, mm, and what its file leaves open."""

    values: np.ndarray
    ijkToRas: np.ndarray
    warnings: tuple[str, ...] = ()


def imageOfNode(node: slicer.vtkMRMLScalarVolumeNode) -> Volume:
    """Return the image of a volume node where its transforms place it, at once: it is not copied.

    Its values are of the node's own type; `asFloat` copies them, in any thread.
    """
    storage = node.GetStorageNode()
    path = storage.GetFullNameFromFileName() if storage is not None else ""
    missing = missingOrientation(Path(path)) if path else ""
    if missing:
        raise InputError(
            f"The file of the volume {node.GetName()} does not state the patient's orientation "
            f"({missing}): left and right, front and back are unknown. Make sure that the slice "
            "views show them as they are, then save the volume as NRRD, which states it."
        )
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
    return replace(volume, values=volume.values.astype(np.float32))


def toWorld(node: slicer.vtkMRMLTransformableNode) -> np.ndarray:
    """Return the (4, 4) matrix, mm, of a node's parent transforms."""
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
    downMm = float(np.ptp(heights))
    count = int(np.ceil(downMm / abs(volume.ijkToRas[2, axis]) - 1e-6))
    widths = [(0, 0)] * 3
    widths[axis] = (count, 0) if end == 0 else (0, count)
    matrix = volume.ijkToRas.copy()
    matrix[:3, 3] -= widths[axis][0] * matrix[:3, axis]
    volume = Volume(np.pad(volume.values, widths, mode="edge"), matrix)
    shape = tuple(int(n) for n in np.floor((top - origin) / spacingMm + 1e-6) + 1)
    return Volume(sampled(volume, gridToRas, shape), gridToRas)


def sampled(volume: Volume, gridToRas: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Return a volume's values (i, j, k) float at the places of a grid, linearly interpolated.

    Places outside the volume get its lowest value, air: 0 HU would be tissue.
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


SPACING_MM = 1.0
"""Size of the voxels."""
BELOW_BASE_MM = 3.0
"""How far a segment continues below the base, so that its end does not affect the cut."""


@dataclass(frozen=True)
class HeadSettings:
    """Settings of the extraction."""

    threshold: float | None = None
    """Value that parts air from skin; None finds it (Otsu; −475 HU of a CT)."""
    baseMm: float | None = None
    """Height (S) of the flat base; None for just above the image's lower edge, or the neck."""
    noiseMm: float = 1.0
    """Standard deviation of the smoothing of the image."""
    openingMm: float = 12.0
    """Openings up to this width do not count as part of the skin's outside."""


@dataclass(frozen=True)
class HeadBody:
    """A head as voxels of 1 mm along RAS, before it becomes a surface.

    `level` (i, j, k) is positive inside, its zero where the skin is; `body` is without cavities and
    tunnels; `origin` is RAS mm of voxel 0, 0, 0; `threshold` parts air from skin.
    """

    level: np.ndarray
    body: np.ndarray
    origin: np.ndarray
    baseMm: float
    threshold: float
    isCt: bool

    @cached_property
    def labels(self) -> tuple[np.ndarray, np.ndarray]:
        """The body as a segment has it, (k, j, i) uint8, and where its first voxel is, RAS mm."""
        below = max(0, round((self.baseMm - BELOW_BASE_MM - self.origin[2]) / SPACING_MM))
        voxels = np.ascontiguousarray(self.body[:, :, below:].transpose(2, 1, 0), np.uint8)
        return voxels, self.origin + np.array([0.0, 0.0, below * SPACING_MM])


SEGMENT_NAME = "Head"
BASE_TAG = "RASTrainer.baseMm"
EDITED_NOISE_MM = 0.8
_HALF = 0.5
_AIR = 2


def showSegment(node: Any, head: HeadBody) -> str:
    """Put a head into a `vtkMRMLSegmentationNode` as a segment and return the segment's ID.

    The segment ends 3 mm below the head's base, whose height (S) is kept in its tag `BASE_TAG`.
    """
    import slicer

    voxels, origin = head.labels
    image = slicer.vtkOrientedImageData(
        dimensions=voxels.shape[::-1], spacing=[SPACING_MM] * 3, origin=origin
    )
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(), deep=True))
    segmentation = node.GetSegmentation()
    former = segmentation.GetSegmentIdBySegmentName(SEGMENT_NAME)
    if former:
        segmentation.RemoveSegment(former)
    name = slicer.vtkSegmentationConverter.GetSegmentationBinaryLabelmapRepresentationName()
    segment = slicer.vtkSegment(name=SEGMENT_NAME)
    segment.SetTag(BASE_TAG, repr(float(head.baseMm)))
    segment.AddRepresentation(name, image)
    segmentation.AddSegment(segment)
    return segmentation.GetSegmentIdBySegmentName(SEGMENT_NAME)


@dataclass(frozen=True)
class SegmentImage:
    """A segment as it is in the scene: `labels`, 0 outside, end where the segment does.

    `baseMm` is the height (S) of the base that was shown with it, −∞ where none was.
    """

    labels: Volume
    baseMm: float


def readSegment(node: Any, segmentId: str) -> SegmentImage:
    """Return a segment of a `vtkMRMLSegmentationNode`, copied."""
    import slicer

    image = slicer.vtkOrientedImageData()
    if not segmentId or not node.GetBinaryLabelmapRepresentation(segmentId, image):
        raise InputError(
            "The segment of the head does not exist; choose another one, or make it again."
        )
    array = image.GetPointData().GetScalars()
    if array is None:
        raise InputError("The segment of the head is empty.")
    matrix = vtk.vtkMatrix4x4()
    image.GetImageToWorldMatrix(matrix)
    first = np.array(image.GetExtent()[::2], dtype=float)
    toRas = toWorld(node) @ matrixOf(matrix)
    toRas[:3, 3] += toRas[:3, :3] @ first
    labels = vtk_to_numpy(array).reshape(image.GetDimensions()[::-1]).transpose(2, 1, 0)
    baseMm, tag = -np.inf, vtk.reference("")
    if node.GetSegmentation().GetSegment(segmentId).GetTag(BASE_TAG, tag):
        bounds = [0.0] * 6
        node.GetSegmentation().GetBounds(bounds)
        middle = [np.mean(bounds[:2]), np.mean(bounds[2:4]), float(tag.get()), 1.0]
        baseMm = float((toWorld(node) @ middle)[2])
    return SegmentImage(Volume(labels, toRas), baseMm)


def volumeOfSegment(segment: SegmentImage) -> Volume:
    """Return a segment as a binary volume, for `findHead` with `forSegment`.

    Its grid has 1 mm along RAS; the Segment Editor may have changed the segment's own grid. It
    begins so that the base is cut where it was (to half a voxel) when the segment was shown, or,
    where the segment ends higher by now, just above that end.
    """
    inside = segment.labels.values > 0
    if not inside.any():
        raise InputError("The segment of the head is empty.")
    bare = Volume(inside.astype(np.float32), segment.labels.ijkToRas)
    widths = np.full((3, 2), _AIR)
    axis, end = lowestSlice(bare)
    widths[axis, 0 if end == 0 else 1] = 0
    matrix = bare.ijkToRas.copy()
    matrix[:3, 3] -= matrix[:3, :3] @ widths[:, 0]
    grid = onRasGrid(Volume(np.pad(bare.values, widths), matrix), SPACING_MM)
    # Without slices more than a voxel below its base.
    heights = grid.ijkToRas[2, 3] + SPACING_MM * np.arange(grid.values.shape[2])
    isBelow = heights <= segment.baseMm - 1.5 * SPACING_MM
    isWanted = (grid.values > _HALF).any(axis=(0, 1)) & ~isBelow
    if np.count_nonzero(isWanted) < 2:
        raise InputError("The segment of the head is empty above its base.")
    start = int(isWanted.argmax())
    matrix = grid.ijkToRas.copy()
    matrix[2, 3] += start * SPACING_MM
    return Volume(grid.values[:, :, start:], matrix)


def forSegment(settings: HeadSettings) -> HeadSettings:
    return replace(settings, threshold=_HALF, noiseMm=EDITED_NOISE_MM)
