"""DICOM as scanners and archives write it: any orientation, any company, any place of the files."""

import io

import numpy as np
import pydicom
import pytest
from PIL import Image
from pydicom.encaps import encapsulate
from pydicom.uid import JPEG2000Lossless, RLELossless
from scipy.spatial.transform import Rotation

from rastrainer.errors import InputError
from rastrainer_headless.volume_files import readVolume
from Testing.slicer.head.dicom_series import LPS_TO_RAS, enhanced, slices, write_slices

SHAPE = (9, 7, 12)
VALUES = np.random.default_rng(4).integers(0, 900, SHAPE).astype(np.int16)
AXIAL = np.eye(3)
SAGITTAL = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]])
CORONAL = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0]])
STEEP = Rotation.from_euler("xyz", [40.0, -35.0, 50.0], degrees=True).as_matrix()


def placed(axes=AXIAL, spacing=(2.0, 3.0, 4.0)):
    """Return a matrix (4, 4) from indices to LPS, mm."""
    matrix = np.eye(4)
    matrix[:3, :3] = axes * spacing
    matrix[:3, 3] = [-70.5, 31.25, 900.0]
    return matrix


def expect(volume, values=VALUES, lps_matrix=None):
    """Check that each voxel is where it was, with the slices counted in either direction."""
    lps = placed() if lps_matrix is None else lps_matrix
    ijk = np.indices(values.shape).reshape(3, -1)
    ras = (LPS_TO_RAS @ lps @ np.vstack([ijk, np.ones(ijk.shape[1])]))[:3]
    inverse = np.linalg.inv(volume.ijkToRas)
    found = inverse[:3, :3] @ ras + inverse[:3, 3:]
    assert np.abs(found - np.rint(found)).max() < 1e-3
    i, j, k = np.rint(found).astype(int)
    assert np.array_equal(volume.values[i, j, k], values.ravel())
    assert volume.values.size == values.size


def tilted(matrix):
    """As by the gantry of a scanner."""
    matrix[1, 2] = 1.2
    return matrix


@pytest.mark.parametrize(
    "matrix",
    [
        *(placed(axes) for axes in (AXIAL, SAGITTAL, CORONAL, STEEP)),
        *(placed(axes * [1.0, 1.0, -1.0]) for axes in (AXIAL, STEEP)),
        tilted(placed()),
    ],
    ids=["A", "S", "C", "O", "A, counted down", "O, counted down", "tilted"],
)
def test_a_series_is_read_however_its_slices_lie(tmp_path, matrix):
    write_slices(tmp_path, slices(VALUES, matrix))
    expect(readVolume(tmp_path), lps_matrix=matrix)


def test_anything_that_is_no_slice_of_the_series_is_ignored(tmp_path):
    write_slices(tmp_path / "study" / "series", slices(VALUES, placed()))
    # A scout, a picture of a screen, a dose report, and a presentation state.
    write_slices(
        tmp_path / "study", slices(VALUES[:, :, :2], placed(CORONAL), ImageType=["LOCALIZER"])
    )
    (screen,) = slices(VALUES[:, :, :1], placed(), "1.2.7")
    del screen.ImagePositionPatient
    screen.save_as(tmp_path / "screen", enforce_file_format=True)
    for name, kind in (
        ("SR", "1.2.840.10008.5.1.4.1.1.88.67"),
        ("PR", "1.2.840.10008.5.1.4.1.1.11.1"),
    ):
        (other,) = slices(VALUES[:, :, :1], placed(), "1.2.8")
        for tag in ("PixelData", "Rows", "Columns", "ImagePositionPatient"):
            delattr(other, tag)
        other.SOPClassUID, other.Modality = kind, name
        other.save_as(tmp_path / name, enforce_file_format=True)
    (tmp_path / "README").write_text("\x08 no DICOM")
    volume = readVolume(tmp_path)
    expect(volume)
    assert volume.warnings == ()


@pytest.mark.parametrize("is_implicit", [False, True])
def test_files_without_preamble_are_read(tmp_path, is_implicit):
    for k, each in enumerate(slices(VALUES, placed())):
        del each.file_meta
        each.save_as(tmp_path / f"I{k}", implicit_vr=is_implicit, little_endian=True)
    expect(readVolume(tmp_path))


def test_frames_of_an_enhanced_file_are_slices_alone_or_in_a_folder(tmp_path):
    matrix = placed(SAGITTAL)
    image = enhanced(VALUES, matrix)
    image.save_as(tmp_path / "all.dcm", enforce_file_format=True)
    for path in (tmp_path, tmp_path / "all.dcm"):
        expect(readVolume(path), lps_matrix=matrix)


def rle(image):
    image.compress(RLELossless)


def jpeg2000(image):
    values = image.pixel_array.astype(np.uint16)
    file = io.BytesIO()
    Image.fromarray(values).save(file, "JPEG2000", no_jp2=True, irreversible=False)
    image.PixelRepresentation = 0
    image.PixelData = encapsulate([file.getvalue()])
    image.file_meta.TransferSyntaxUID = JPEG2000Lossless


@pytest.mark.parametrize("compress", [rle, jpeg2000])
def test_compressed_pixels_are_read(tmp_path, compress):
    datasets = slices(np.repeat(np.repeat(VALUES, 8, 0), 8, 1), placed())
    for each in datasets:
        compress(each)
    write_slices(tmp_path, datasets)
    expect(readVolume(tmp_path), np.repeat(np.repeat(VALUES, 8, 0), 8, 1))


def test_values_are_scaled_slice_by_slice(tmp_path):
    datasets = slices(VALUES, placed())
    for k, each in enumerate(datasets):
        each.RescaleSlope, each.RescaleIntercept = "2", str(-1024 - k)
    write_slices(tmp_path, datasets)
    scaled = 2.0 * VALUES - 1024.0 - np.arange(SHAPE[2])
    expect(readVolume(tmp_path), scaled)


def test_the_same_slices_twice_are_taken_once(tmp_path):
    write_slices(tmp_path / "one", slices(VALUES, placed()))
    write_slices(tmp_path / "copied", slices(VALUES, placed()))
    write_slices(tmp_path / "sent again", slices(VALUES, placed())[3:6])
    for k, path in enumerate(sorted((tmp_path / "sent again").iterdir())):
        image = pydicom.dcmread(path)
        image.SOPInstanceUID = f"1.2.99.{k}"
        image.save_as(path)
    expect(readVolume(tmp_path))


def test_the_larger_of_two_series_is_taken_and_named(tmp_path):
    write_slices(tmp_path, slices(VALUES, placed(), SeriesDescription="T1 MPRAGE"), "a")
    flair = slices(VALUES[:, :, :10] + 7, placed(), "1.2.4", SeriesDescription="FLAIR")
    write_slices(tmp_path, flair, "b")
    volume = readVolume(tmp_path)
    expect(volume)
    assert "2 series of many slices" in volume.warnings[0]
    assert "“T1 MPRAGE” with 12" in volume.warnings[0]


def test_two_echoes_of_one_series_are_two_stacks(tmp_path):
    write_slices(tmp_path / "1", slices(VALUES, placed(), EchoTime="4"))
    second = slices(VALUES + 3, placed(), EchoTime="9")
    for k, each in enumerate(second):
        each.SOPInstanceUID = f"1.2.5.{k}"
    write_slices(tmp_path / "2", second[:-1])
    expect(readVolume(tmp_path))


def without(datasets):
    del datasets[5]


def over_time(datasets):
    later = slices(VALUES + 5, placed())
    for k, each in enumerate(later):
        each.SOPInstanceUID = f"1.2.6.{k}"
    datasets += later


def alone(datasets):
    del datasets[1:]


def sideways(datasets):
    datasets[4].ImagePositionPatient = [-60.5, 31.25, 916.0]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (without, "are not evenly spaced, but 4.00 to 8.00 mm apart: some are missing"),
        (over_time, "has different images at the same place"),
        (sideways, "do not lie in one line"),
        (alone, "no series of at least 8 slices"),
    ],
)
def test_a_series_that_is_no_volume_is_refused_and_says_why(tmp_path, change, sentence):
    datasets = slices(VALUES, placed())
    change(datasets)
    write_slices(tmp_path, datasets)
    with pytest.raises(InputError, match=sentence):
        readVolume(tmp_path)
