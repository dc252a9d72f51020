"""The head as a segment that the Segment Editor can change, and back."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.slicer.head.volume import (
    SPACING_MM,
    HeadBody,
    HeadSettings,
    Volume,
    lowestSlice,
    matrixOf,
    onRasGrid,
    toWorld,
)

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
    image = slicer.vtkOrientedImageData()
    image.SetDimensions(voxels.shape[::-1])
    image.SetSpacing([SPACING_MM] * 3)
    image.SetOrigin(*origin)
    image.GetPointData().SetScalars(numpy_to_vtk(voxels.ravel(), deep=True))
    segmentation = node.GetSegmentation()
    former = segmentation.GetSegmentIdBySegmentName(SEGMENT_NAME)
    if former:
        segmentation.RemoveSegment(former)
    name = slicer.vtkSegmentationConverter.GetSegmentationBinaryLabelmapRepresentationName()
    segment = slicer.vtkSegment()
    segment.SetName(SEGMENT_NAME)
    segment.SetTag(BASE_TAG, repr(float(head.baseMm)))
    segment.AddRepresentation(name, image)
    segmentation.AddSegment(segment)
    return segmentation.GetSegmentIdBySegmentName(SEGMENT_NAME)


@dataclass(frozen=True)
class SegmentImage:
    """A segment as it is in the scene.

    Attributes:
        labels: 0 outside; its image ends where the segment does.
        baseMm: height (S) of the base that was shown with it, −∞ where none was.
    """

    labels: Volume
    baseMm: float


def readSegment(node: Any, segmentId: str) -> SegmentImage:
    """Return a segment of a `vtkMRMLSegmentationNode`, copied.

    Raises:
        InputError: it is not there, or its transform is not linear.
    """
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
    return SegmentImage(Volume(labels, toRas), _baseOf(node, segmentId))


def volumeOfSegment(segment: SegmentImage) -> Volume:
    """Return a segment as a volume of zeros and ones, for `findHead` with `forSegment`.

    Its grid is of 1 mm along RAS, whatever grid the Segment Editor has given the segment. It
    begins so that the base is cut where it was (to half a voxel) when the segment was shown, or,
    where the segment ends higher by now, just above that end.

    Raises:
        InputError: the segment is empty.
    """
    inside = segment.labels.values > 0
    if not inside.any():
        raise InputError("The segment of the head is empty.")
    bare = Volume(inside.astype(np.float32), segment.labels.ijkToRas)
    return _fromBase(onRasGrid(_inAir(bare), SPACING_MM), segment.baseMm)


def forSegment(settings: HeadSettings) -> HeadSettings:
    """Return the settings for a segment's volume."""
    return replace(settings, threshold=_HALF, noiseMm=EDITED_NOISE_MM)


def _inAir(bare: Volume) -> Volume:
    """Return a segment with air around it, but below, where the neck continues.

    The segment's image ends where the segment does.
    """
    widths = np.full((3, 2), _AIR)
    axis, end = lowestSlice(bare)
    widths[axis, 0 if end == 0 else 1] = 0
    matrix = bare.ijkToRas.copy()
    matrix[:3, 3] -= matrix[:3, :3] @ widths[:, 0]
    return Volume(np.pad(bare.values, widths), matrix)


def _baseOf(node: Any, segmentId: str) -> float:
    """Return the height (S) of the base that was shown with a segment, −∞ where none was."""
    tag = vtk.reference("")
    if not node.GetSegmentation().GetSegment(segmentId).GetTag(BASE_TAG, tag):
        return -np.inf
    bounds = [0.0] * 6
    node.GetSegmentation().GetBounds(bounds)
    middle = [np.mean(bounds[:2]), np.mean(bounds[2:4]), float(tag.get()), 1.0]
    return float((toWorld(node) @ middle)[2])


def _fromBase(grid: Volume, baseMm: float) -> Volume:
    """Return a segment's volume without what is more than a voxel below its base."""
    lowest = grid.ijkToRas[2, 3]
    heights = lowest + SPACING_MM * np.arange(grid.values.shape[2])
    isWanted = (grid.values > _HALF).any(axis=(0, 1)) & (heights > baseMm - 1.5 * SPACING_MM)
    if np.count_nonzero(isWanted) < 2:
        raise InputError("The segment of the head is empty above its base.")
    start = int(isWanted.argmax())
    matrix = grid.ijkToRas.copy()
    matrix[2, 3] += start * SPACING_MM
    return Volume(grid.values[:, :, start:], matrix)
