"""Volumes that are broken or no heads: one sentence each. Odd but sound ones are used."""

import gzip

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.slicer.head.dicom_series import read_dicom_folder
from rastrainer.slicer.head.head_draft import make_draft, read_any_volume
from rastrainer.slicer.head.volume import Volume
from rastrainer.slicer.head.volume_checks import check_volume
from Testing.slicer.head.dicom_series import write_series


def volume(shape=(100, 100, 100), spacing=(1.5, 1.5, 1.5), fill=None):
    values = np.zeros(shape, np.float32)
    if fill is None:
        values[tuple(slice(n // 4, 3 * n // 4) for n in shape)] = 100.0
    else:
        values += fill
    return Volume(values, np.diag([*spacing, 1.0]))


def with_nan():
    broken = volume()
    broken.values[3, 4, 5] = np.nan
    return broken


def sheared():
    broken = volume()
    broken.ijk_to_ras[:3, 1] = broken.ijk_to_ras[:3, 0]
    return broken


def noise():
    values = np.random.default_rng(1).uniform(0, 100, (60, 60, 60)).astype(np.float32)
    return Volume(values, np.diag([1.6, 1.6, 1.6, 1.0]))


@pytest.mark.parametrize(
    ("broken", "sentence"),
    [
        pytest.param(volume(fill=0.0), "The volume is empty", id="empty"),
        pytest.param(volume((200, 200, 1)), "needs a 3D volume", id="2D"),
        pytest.param(with_nan(), "no numbers", id="NaN"),
        pytest.param(volume(spacing=(0.0015,) * 3), "not in millimeters", id="meters"),
        pytest.param(volume(spacing=(1500.0,) * 3), "not in millimeters", id="micrometers"),
        pytest.param(volume(spacing=(1.0, 1.0, 9.0)), "9.0 mm apart", id="9 mm slices"),
        pytest.param(volume(spacing=(1.0, 1.0, 0.0)), "does not tell where", id="no spacing"),
        pytest.param(sheared(), "orientation is damaged", id="axes that coincide"),
    ],
)
def test_a_broken_volume_is_refused_with_a_sentence(broken, sentence):
    with pytest.raises(InputError, match=sentence) as caught:
        check_volume(broken)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("none", [noise(), volume((100, 100, 100), (1.2, 1.2, 1.2))])
def test_a_volume_without_a_head_is_refused_with_a_sentence(none):
    with pytest.raises(InputError, match="No head was found"):
        make_draft(none, has_skull=False)


def test_thick_slices_are_used_with_a_warning():
    assert "5.0 mm apart" in check_volume(volume((100, 100, 40), (1.0, 1.0, 5.0)))[0]


def test_a_cut_file_is_refused_with_a_sentence(tmp_path):
    header = b"NRRD0004\ntype: short\ndimension: 3\nspace: left-posterior-superior\nsizes: 90 90 90"
    header += b"\nspace directions: (1,0,0) (0,1,0) (0,0,1)\nspace origin: (0,0,0)\n"
    header += b"endian: little\nencoding: gzip\n\n"
    path = tmp_path / "cut.nrrd"
    data = gzip.compress(np.random.default_rng(1).integers(0, 99, 90**3, np.int16).tobytes())
    path.write_bytes(header + data[: len(data) // 3])
    with pytest.raises(InputError, match=r"cut\.nrrd could not be read|no numbers|empty"):
        check_volume(read_any_volume(path))


def test_a_dicom_series_is_read_by_position_whatever_its_files_are_called(tmp_path):
    values = np.arange(20 * 24 * 16, dtype=np.int16).reshape(20, 24, 16)
    write_series(tmp_path, values, (2.0, 3.0, 4.0), first=(-10.0, -20.0, -30.0))
    write_series(tmp_path, values[:, :, :9] + 7, (2.0, 3.0, 4.0), series="1.2.3.5")
    (tmp_path / "notes.txt").write_text("no image")
    read = read_dicom_folder(tmp_path)
    assert np.array_equal(read.values, values)
    # DICOM is LPS, the volume RAS: x and y change their signs.
    assert np.allclose(read.ijk_to_ras[:3, :3], np.diag([-2, -3, 4]))
    assert np.allclose(read.ijk_to_ras[:3, 3], [10, 20, -30])


def test_a_series_that_lacks_a_slice_is_refused(tmp_path):
    values = np.zeros((20, 20, 12), np.int16)
    write_series(tmp_path, values, (1.0, 1.0, 2.0))
    sorted(tmp_path.iterdir())[4].unlink()
    with pytest.raises(InputError, match="not evenly spaced"):
        read_dicom_folder(tmp_path)


@pytest.mark.parametrize("content", [b"", bytes(128) + b"DICM" + b"\x02\x00garbage" * 40])
def test_a_folder_without_readable_dicom_is_refused(tmp_path, content):
    (tmp_path / "a.dcm").write_bytes(content)
    with pytest.raises(InputError, match="DICOM"):
        read_dicom_folder(tmp_path)
