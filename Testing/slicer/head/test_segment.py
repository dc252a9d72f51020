"""A head that is found becomes a segment; what the Segment Editor makes of it becomes the head."""

import numpy as np
import pytest
import slicer
import vtk

from rastrainer.errors import InputError
from rastrainer.slicer.head.extraction import findHead, skinOf
from rastrainer.slicer.head.volume import (
    HeadBody,
    HeadSettings,
    forSegment,
    readSegment,
    showSegment,
    volumeOfSegment,
)
from rastrainer.work_progress import no_progress
from Testing.slicer.head.placed import add_transform

BASE = -30.3
CENTER, RADIUS, NECK = np.array([0.0, 5.0, 0.0]), 22.0, 15.0


@pytest.fixture
def found():
    """A ball on a neck, which continues below the base as `findHead` lets it."""
    origin = np.array([-27.0, -22.0, BASE - 15.0])
    grid = np.indices((54, 54, 72)).transpose(1, 2, 3, 0) + origin - CENTER
    ball = RADIUS - np.linalg.norm(grid, axis=3)
    neck = NECK - np.linalg.norm(grid[..., :2], axis=3)
    level = np.clip(np.maximum(ball, np.where(grid[..., 2] < 0.0, neck, -1.0)), -1.0, 1.0)
    return HeadBody(level, level > 0, origin, BASE, 50.0, False)


@pytest.fixture
def node(scene):
    return scene.AddNewNodeByClass("vtkMRMLSegmentationNode", "Segmentation")


def lay_on_grid(node, segment, to_ras, shape):
    """Lay a segment on another grid, as the Segment Editor does with the first edit."""
    shown, grid, laid = (slicer.vtkOrientedImageData() for _ in range(3))
    node.GetBinaryLabelmapRepresentation(segment, shown)
    grid.SetDimensions(shape)
    grid.SetImageToWorldMatrix(slicer.util.vtkMatrixFromArray(to_ras))
    grid.AllocateScalars(vtk.VTK_UNSIGNED_CHAR, 1)
    resample = slicer.vtkOrientedImageDataResample
    resample.ResampleOrientedImageToReferenceOrientedImage(shown, grid, laid)
    labelmap = slicer.vtkSegmentationConverter.GetSegmentationBinaryLabelmapRepresentationName()
    node.GetSegmentation().GetSegment(segment).AddRepresentation(labelmap, laid)


def skin_of(node, segment, **settings):
    """Return the surface of the head that is made of a segment."""
    wanted = forSegment(HeadSettings(**settings))
    volume = volumeOfSegment(readSegment(node, segment))
    return skinOf(findHead(volume, wanted, no_progress), no_progress)


def ball_errors(mesh):
    """Return how far the vertices above the neck are from the ball, mm, (n,)."""
    upper = mesh.vertices[mesh.vertices[:, 2] > 0.0]
    return np.abs(np.linalg.norm(upper - CENTER, axis=1) - RADIUS)


def test_a_head_made_from_its_segment_has_the_base_that_was_shown(node, found):
    showSegment(node, found)
    segment = showSegment(node, found)
    assert node.GetSegmentation().GetNumberOfSegments() == 1
    mesh = skin_of(node, segment)
    assert mesh.is_closed
    assert mesh.vertices[:, 2].min() == pytest.approx(BASE, abs=0.001)
    assert ball_errors(mesh).mean() < 0.5


def test_a_requested_cut_overrides_the_base_of_which_hardly_more_is_shown(node, found):
    segment = showSegment(node, found)
    mesh = skin_of(node, segment, baseMm=-10.0)
    assert mesh.vertices[:, 2].min() == pytest.approx(-10.0, abs=0.001)
    bounds = [0.0] * 6
    node.GetSegmentation().GetBounds(bounds)
    assert BASE - 4.0 < bounds[4] < BASE


def oblique(axes, center):
    """Return a grid's matrix, turned by 12° about R, with CENTER at the index `center`."""
    c, s = np.cos(np.radians(12.0)), np.sin(np.radians(12.0))
    to_ras = np.eye(4)
    to_ras[:3, :3] = 1.7 * np.array([[1, 0, 0], [0, c, -s], [0, s, c]])[:, axes]
    to_ras[:3, 3] = CENTER - to_ras[:3, :3] @ center
    return to_ras


def assert_rests_on_the_whole_neck(mesh):
    base = mesh.vertices[:, 2].min()
    rim = mesh.vertices[mesh.vertices[:, 2] < base + 0.001]
    np.testing.assert_allclose(np.ptp(rim[:, :2], axis=0), 2 * NECK, atol=2.5)


@pytest.mark.parametrize("axes", [(0, 1, 2), (1, 2, 0)], ids=["axial", "sagittal"])
def test_the_base_stays_when_an_edit_moves_the_segment_to_an_oblique_grid(node, found, axes):
    segment = showSegment(node, found)
    lay_on_grid(node, segment, oblique(axes, [27.0, 27.0, 27.0]), (54, 54, 54))
    mesh = skin_of(node, segment)
    assert mesh.vertices[:, 2].min() == pytest.approx(BASE, abs=0.51)
    assert_rests_on_the_whole_neck(mesh)
    assert ball_errors(mesh).mean() < 0.5


def test_a_moved_segment_moves_its_head(scene, node, found):
    segment = showSegment(node, found)
    node.SetAndObserveTransformNodeID(add_transform(scene, [5.0, -7.0, 11.0]).GetID())
    mesh = skin_of(node, segment)
    assert mesh.vertices[:, 2].min() == pytest.approx(BASE + 11.0, abs=0.001)
    mesh.vertices[:] -= [5.0, -7.0, 11.0]
    assert ball_errors(mesh).mean() < 0.5


def test_an_empty_segment_is_refused_with_a_message(node, found):
    with pytest.raises(InputError, match="segment of the head does not exist"):
        volumeOfSegment(readSegment(node, "Segment_1"))
    found.body[:, :, round(BASE - found.origin[2]) :] = False
    with pytest.raises(InputError, match="empty above its base"):
        volumeOfSegment(readSegment(node, showSegment(node, found)))
    del found.__dict__["labels"]
    found.body[:] = False
    segment = showSegment(node, found)
    with pytest.raises(InputError, match="segment of the head is empty"):
        volumeOfSegment(readSegment(node, segment))
