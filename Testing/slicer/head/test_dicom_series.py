"""DICOM as scanners and archives write it, also cut or damaged, wherever the files are."""

import io
import struct
import tracemalloc

import numpy as np
import pytest
from PIL import Image
from pydicom.encaps import encapsulate
from pydicom.uid import JPEG2000Lossless
from scipy.spatial.transform import Rotation

from rastrainer.errors import InputError
from rastrainer_headless.dicom_series import readDicom
from rastrainer_headless.volume_files import readVolume
from Testing.slicer.head.dicom_series import LPS_TO_RAS, enhanced, slice_file, slices, write_slices

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


def test_frames_of_an_enhanced_file_are_slices_alone_or_in_a_folder(tmp_path):
    matrix = placed(SAGITTAL)
    image = enhanced(VALUES, matrix)
    image.save_as(tmp_path / "all.dcm", enforce_file_format=True)
    for path in (tmp_path, tmp_path / "all.dcm"):
        expect(readVolume(path), lps_matrix=matrix)


def test_compressed_pixels_are_read(tmp_path):
    values = np.repeat(np.repeat(VALUES, 8, 0), 8, 1)
    datasets = slices(values, placed())
    for each in datasets:
        file = io.BytesIO()
        pixels = Image.fromarray(each.pixel_array.astype(np.uint16))
        pixels.save(file, "JPEG2000", no_jp2=True, irreversible=False)
        each.PixelRepresentation = 0
        each.PixelData = encapsulate([file.getvalue()])
        each.file_meta.TransferSyntaxUID = JPEG2000Lossless
    write_slices(tmp_path, datasets)
    expect(readVolume(tmp_path), values)


def test_values_are_scaled_slice_by_slice(tmp_path):
    datasets = slices(VALUES, placed())
    for k, each in enumerate(datasets):
        each.RescaleSlope, each.RescaleIntercept = "2", str(-1024 - k)
    write_slices(tmp_path, datasets)
    scaled = 2.0 * VALUES - 1024.0 - np.arange(SHAPE[2])
    expect(readVolume(tmp_path), scaled)


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


def slice_at(number):
    """The bytes of one of nine slices."""
    values = np.zeros((8, 8), np.int16)
    return slice_file(values, (1.0, 1.0, 1.0), (0.0, 0.0, float(number)), "1.2.3", number)


SLICE = slice_at(4)
META = 132 + SLICE[132:].index(b"\x08\x00\x16\x00")
FOUR_GB = 0xFFFFFFF0
UNDEFINED = 0xFFFFFFFF
ITEM, END_OF_ITEM, END_OF_SEQUENCE = ((0xFFFE, number) for number in (0xE000, 0xE00D, 0xE0DD))


def plain(tag, length=0):
    """An element of implicit kind, or one of a sequence's own."""
    return struct.pack("<HHI", *tag, length)


def long(tag, kind, length):
    """The head of an element whose length has four bytes."""
    return struct.pack("<HH2sHI", *tag, kind, 0, length)


def with_first(elements, syntax=b"1.2.840.10008.1.2.1\0"):
    """The slice with elements at the start of its data set, and in another transfer syntax."""
    meta = SLICE[:META].replace(b"1.2.840.10008.1.2.1\0", syntax)
    assert len(meta) == META
    return meta + elements + SLICE[META:]


def sequence(length, items):
    return long((0x0008, 0x1140), b"SQ", length) + items


def write(folder, content):
    """Write nine slices, of which the fifth has this content."""
    for number in range(9):
        (folder / f"{number}.dcm").write_bytes(content if number == 4 else slice_at(number))


HUGE = long((0x0009, 0x1001), b"OB", FOUR_GB)
SMALL = struct.pack("<HH2sH6s", 0x0008, 0x1155, b"UI", 6, b"1.2.3")
ENDS = plain(END_OF_ITEM) + plain(END_OF_SEQUENCE)


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(
            with_first(sequence(UNDEFINED, plain(ITEM, UNDEFINED) + HUGE + ENDS)), id="in an item"
        ),
        pytest.param(
            with_first(plain((0x0009, 0x1001), FOUR_GB), b"1.2.840.10008.1.2\0  "), id="implicit"
        ),
        pytest.param(SLICE[:-2], id="pixels"),
    ],
)
def test_a_file_that_claims_more_than_it_holds_is_refused_without_its_memory(content, tmp_path):
    write(tmp_path, content)
    tracemalloc.start()
    with pytest.raises(InputError, match=r"4\.dcm is cut short or damaged"):
        readDicom(tmp_path)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert most < 50e6


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(
            with_first(sequence(UNDEFINED, plain(ITEM, UNDEFINED) + SMALL + ENDS)),
            id="sequence of unknown length",
        ),
        pytest.param(
            with_first(sequence(8 + len(HUGE), plain(ITEM, len(HUGE)) + HUGE)),
            id="a sequence that can be skipped whatever it claims",
        ),
    ],
)
def test_a_complete_file_is_not_called_truncated(content, tmp_path):
    write(tmp_path, content)
    assert readDicom(tmp_path).values.shape == (8, 8, 9)
