"""Volumes that are broken or not heads: one error each. Odd but sound volumes are used."""

import pytest

from rastrainer.errors import InputError
from rastrainer.slicer.head.head_draft import checkVolume, makeDraft
from rastrainer_headless.dicom_series import readDicom
from Testing.slicer.head.broken_volumes import HEADLESS, UNUSABLE, block


def sheared():
    broken = block()
    broken.ijkToRas[:3, 1] = broken.ijkToRas[:3, 0]
    return broken


UNPLACED = {
    "no spacing": (block(spacing=(1.0, 1.0, 0.0)), "does not say where"),
    "axes that coincide": (sheared(), "orientation is damaged"),
}


@pytest.mark.parametrize("name", [*UNUSABLE, *UNPLACED])
def test_a_broken_volume_is_refused_with_a_message(name):
    broken, sentence = (UNUSABLE | UNPLACED)[name]
    with pytest.raises(InputError, match=sentence) as caught:
        checkVolume(broken)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", [pytest.param("noise", marks=pytest.mark.soak), "a block"])
def test_a_volume_without_a_head_is_refused_with_a_message(name):
    none, sentence = HEADLESS[name]
    with pytest.raises(InputError, match=sentence):
        makeDraft(none, hasSkull=False)


def test_thick_slices_are_used_with_a_warning():
    assert "5.0 mm apart" in checkVolume(block((100, 100, 40), (1.0, 1.0, 5.0)))[0]


@pytest.mark.parametrize("content", [b"", bytes(128) + b"DICM" + b"\x02\x00garbage" * 40])
def test_a_folder_without_readable_dicom_is_refused(tmp_path, content):
    (tmp_path / "a.dcm").write_bytes(content)
    with pytest.raises(InputError, match="DICOM"):
        readDicom(tmp_path)
