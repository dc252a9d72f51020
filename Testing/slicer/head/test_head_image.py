"""The images that a scenario carries lie where the head does, small, and of the head alone."""

import numpy as np
import pytest
import slicer

from rastrainer.head.volume import KEPT_MM, MAX_FILE_BYTES, write_nrrd
from rastrainer.slicer.head.extraction import findHead, skinOf
from rastrainer.slicer.head.head_draft import HOUNSFIELD, imageOf
from rastrainer.slicer.head.volume import HeadSettings, Volume
from rastrainer_headless.volume_files import readVolume
from Testing.slicer.head.phantoms import CT, DOUBLE_OBLIQUE, MRI, phantom, voxel_depths

SIZE = 0.4
"""Size of the phantom's head: a small head tests the same, and faster."""


def images(scan):
    """The images of a scan, the sentence on them, and the head in it."""
    head = findHead(scan, HeadSettings(), lambda _step, _share: None)
    return *imageOf(scan, head), head


def depths(volume):
    """How deep below the skin of the phantom each voxel is, (i, j, k), mm."""
    return voxel_depths(volume.values, volume.ijk_to_ras, SIZE)


@pytest.mark.parametrize(
    ("spacing", "axes"),
    [((2.0, 2.0, 2.0), None), ((1.5, 2.0, 3.0), DOUBLE_OBLIQUE)],
    ids=["RAS", "oblique"],
)
def test_mri_lies_on_a_1_mm_grid_where_the_head_is(spacing, axes):
    made, sentence, _head = images(phantom(spacing=spacing, axes=axes, size=SIZE))
    assert np.array_equal(made.ijk_to_ras[:3, :3], np.eye(3))
    assert made.values.dtype == np.uint8
    depth = depths(made)
    assert np.median(made.values[(depth > 2) & (depth < 4)]) > 200
    assert np.median(made.values[depth > 20]) == pytest.approx(255 * 0.75, abs=12)
    assert made.values[(depth < -3) & (depth > -50)].mean() < 5
    assert sentence == "Images: MRI, 1 mm, values from 0 to 100 as 0 to 255."
    assert 150 < made.window <= 255
    assert made.level == made.window / 2


def test_mri_with_8_bit_values_keeps_them():
    scan = phantom(size=SIZE)
    scan = Volume(np.rint(scan.values), scan.ijkToRas)
    made, sentence, _head = images(scan)
    assert sentence == "Images: MRI, 1 mm, its own values, 0 to 255."
    assert np.median(made.values[depths(made) > 20]) == MRI["brain"]


@pytest.fixture(scope="module")
def ct():
    scan = phantom({**CT, "bone": 9000.0}, spacing=(2.0, 2.0, 2.0), lowest=-20.0, size=SIZE)
    return images(scan)


def test_ct_keeps_its_hounsfield_units_within_their_usual_range(ct):
    made, sentence, _head = ct
    assert made.values.dtype == np.int16
    assert made.values.max() == HOUNSFIELD[1]
    depth = depths(made)
    assert np.median(made.values[depth > 20]) == CT["brain"]
    assert np.median(made.values[(depth < -3) & (depth > -50)]) == -1000
    assert sentence == "Images: CT, 1 mm, Hounsfield units from -1024 to 3071."


def test_anything_far_from_the_head_becomes_air():
    scan = phantom(noise=2.0, size=SIZE)
    scan.values[2:8, 2:8, 20:90] = 60.0
    made, _sentence, head = images(scan)
    far = depths(made) < -KEPT_MM - 3.0
    assert not made.values[far & (np.indices(made.values.shape)[2] > 20)].any()
    skin = skinOf(head, lambda _step, _share: None)
    corners = np.array([made.ijk_to_ras[:3, 3], (made.ijk_to_ras @ [*made.values.shape, 1])[:3]])
    assert (corners[0][:2] > skin.vertices.min(axis=0)[:2] - KEPT_MM - 2).all()
    assert (corners[1] < skin.vertices.max(axis=0) + KEPT_MM + 3).all()


def test_slicer_reads_the_file_as_it_was_written(ct, tmp_path):
    made, _sentence, _head = ct
    path = tmp_path / "volume.nrrd"
    write_nrrd(path, made.values, made.ijk_to_ras)
    assert path.stat().st_size < MAX_FILE_BYTES / 2
    read = readVolume(path)
    assert np.array_equal(read.values, made.values)
    assert np.allclose(read.ijkToRas, made.ijk_to_ras)
    storage = slicer.vtkMRMLNRRDStorageNode(file_name=str(path))
    node = slicer.vtkMRMLScene().AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    assert storage.ReadData(node)
    assert np.array_equal(slicer.util.arrayFromVolume(node).T, made.values)
