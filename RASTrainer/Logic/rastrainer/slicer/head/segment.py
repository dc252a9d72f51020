"""The head as a segment that the Segment Editor can change, and back."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import slicer
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.slicer.head.extraction import SPACING_MM, HeadBody, HeadSettings
from rastrainer.slicer.head.volume import Volume, matrix_of

SEGMENT_NAME = "Head"
EDITED_NOISE_MM = 0.8
_HALF = 0.5


def show_segment(node: Any, head: HeadBody) -> str:
    """Put a head into a `vtkMRMLSegmentationNode` as a segment and return the segment's ID."""
    image = slicer.vtkOrientedImageData()
    image.SetDimensions(head.body.shape)
    image.SetSpacing([SPACING_MM] * 3)
    image.SetOrigin(head.origin)
    voxels = np.ascontiguousarray(head.body.transpose(2, 1, 0), np.uint8).ravel()
    image.GetPointData().SetScalars(numpy_to_vtk(voxels, deep=True))
    segmentation = node.GetSegmentation()
    former = segmentation.GetSegmentIdBySegmentName(SEGMENT_NAME)
    if former:
        segmentation.RemoveSegment(former)
    name = slicer.vtkSegmentationConverter.GetSegmentationBinaryLabelmapRepresentationName()
    segment = slicer.vtkSegment()
    segment.SetName(SEGMENT_NAME)
    segment.AddRepresentation(name, image)
    segmentation.AddSegment(segment)
    return segmentation.GetSegmentIdBySegmentName(SEGMENT_NAME)


def volume_of_segment(node: Any, segment_id: str) -> Volume:
    """Return a segment as a volume of zeros and ones, for `extract_head` with `for_segment`.

    Raises:
        InputError: the segment is empty or not there.
    """
    image = slicer.vtkOrientedImageData()
    if not segment_id or not node.GetBinaryLabelmapRepresentation(segment_id, image):
        raise InputError("The segment of the head is not there; choose another, or make it anew.")
    array = image.GetPointData().GetScalars()
    if array is None or not vtk_to_numpy(array).any():
        raise InputError("The segment of the head is empty.")
    matrix = vtk.vtkMatrix4x4()
    image.GetImageToWorldMatrix(matrix)
    first = np.array(image.GetExtent()[::2], dtype=float)
    to_ras = matrix_of(matrix)
    to_ras[:3, 3] += to_ras[:3, :3] @ first
    values = vtk_to_numpy(array).reshape(image.GetDimensions()[::-1]).transpose(2, 1, 0)
    # The segment's image ends where the segment does: there has to be air around it.
    padded = np.pad((values > 0).astype(np.float32), [(2, 2), (2, 2), (0, 2)])
    to_ras[:3, 3] -= to_ras[:3, :3] @ [2.0, 2.0, 0.0]
    return Volume(padded, to_ras)


def for_segment(settings: HeadSettings) -> HeadSettings:
    """Return the settings for a segment's volume."""
    return replace(settings, threshold=_HALF, noise_mm=EDITED_NOISE_MM)
