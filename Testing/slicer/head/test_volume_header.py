"""A file that cannot be used is named with its kind; a missing orientation is never guessed."""

import struct

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.slicer.head.volume import Volume, imageOfNode
from rastrainer_headless.volume_files import readVolume
from Testing.slicer.head.placed import add_volume
from Testing.slicer.head.volume_file import write_volume

SHAPE = (5, 6, 7)
VALUES = np.random.default_rng(2).integers(0, 900, SHAPE).astype(np.int16)
SFORM = [[0.0, 0.0, 2.0, -30.0], [-3.0, 0.0, 0.0, 40.0], [0.0, -4.0, 0.0, 50.0]]
"""Sagittal: to the back, downward and to the right."""
IDENTITY = (0.0, 0.0, 0.0)


def nifti(
    *,
    magic=b"n+1\0",
    sizes=SHAPE,
    kind=(4, 16),
    spacing=(3.0, 4.0, 2.0),
    codes=(0, 1),
    rotation=IDENTITY,
    sform=SFORM,
    order="<",
):
    """Return a NIfTI-1 file (nifti1.h), or Analyze by another `magic`."""
    header = bytearray(352)

    def put(at, form, *values):
        struct.pack_into(order + form, header, at, *values)

    put(0, "i", 348)
    put(40, "8h", len(sizes), *sizes, *[1] * (7 - len(sizes)))
    put(70, "2h", *kind)
    put(76, "4f", 1.0, *spacing)
    put(108, "2f", 352.0 if magic == b"n+1\0" else 0.0, 1.0)
    header[123] = 2
    put(252, "2h", *codes)
    put(256, "3f", *rotation)
    put(280, "12f", *np.ravel(sform))
    header[344:348] = magic
    pixels = VALUES.astype(f"{order}i2").tobytes(order="F")
    return bytes(header) + pixels * max(1, np.prod(sizes[3:], dtype=int)) * (kind[1] // 8)


def sheared():
    turned = np.array(SFORM)
    turned[0, 0] = 1.5
    return turned


def nrrd(*lines):
    """Return an NRRD file of these lines only."""
    fields = ("NRRD0004", "type: short", "encoding: raw", "endian: little", *lines)
    return "\n".join(fields).encode() + b"\n\n" + VALUES.tobytes(order="F") * 4


NIFTI_2 = struct.pack("<i", 540) + b"n+2\0\r\n\x1a\n" + bytes(540)
UNUSABLE = {
    "time.nii": (nifti(sizes=(*SHAPE, 2)), r"has 4 dimensions \(5 × 6 × 7 × 2\)"),
    "rgb.nii": (nifti(kind=(128, 24)), r"has colors \(RGB\)"),
    "sheared.nii": (nifti(sform=sheared()), "has a sheared sform"),
    "two.nii": (nifti(codes=(1, 1)), r"contradict each other \(RAS and PIR\)"),
    "nifti2.nii": (NIFTI_2, "is NIfTI-2"),
    "rgb.nrrd": (
        nrrd("dimension: 4", "sizes: 3 5 6 7", "kinds: RGB-color domain domain domain"),
        "several in a voxel",
    ),
}


@pytest.mark.parametrize("name", UNUSABLE)
def test_a_file_that_cannot_be_used_says_what_it_is(tmp_path, name):
    content, sentence = UNUSABLE[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError, match=sentence) as caught:
        readVolume(tmp_path / name)
    assert "\n" not in str(caught.value)


UNPLACED = {
    "codes.nii": (nifti(codes=(0, 0)), "qform_code and sform_code are 0"),
    "bare.nrrd": (
        nrrd("dimension: 3", "sizes: 5 6 7", "spacings: 3 4 2"),
        "it has no space directions",
    ),
}


def analyze(folder, origin=(0, 0, 0)):
    """Write an Analyze file; SPM keeps an origin, in voxels, where NIfTI has its codes."""
    header = bytearray(nifti(magic=bytes(4), codes=(0, 0))[:348])
    struct.pack_into("<3h", header, 253, *origin)
    (folder / "head.hdr").write_bytes(header)
    (folder / "head.img").write_bytes(VALUES.tobytes(order="F"))
    return folder / "head.img"


def unplaced(folder, name):
    """Write a file without an orientation and return its path."""
    if name.startswith("Analyze"):
        path = analyze(folder, (3, 3, 4) if "origin" in name else (0, 0, 0))
        return path.with_suffix(".hdr") if "header" in name else path
    (folder / name).write_bytes(UNPLACED[name][0])
    return folder / name


NAMES = [*UNPLACED, "Analyze", "Analyze, by its header", "Analyze with an origin"]


@pytest.mark.parametrize("name", NAMES)
def test_a_file_without_orientation_is_refused_unless_the_user_states_it(tmp_path, name):
    path = unplaced(tmp_path, name)
    with pytest.raises(InputError, match="does not state the patient's orientation") as caught:
        readVolume(path)
    assert UNPLACED.get(name, ("", "Analyze files have none"))[1] in str(caught.value)
    for letters, columns in (
        ("LAS", [[-3, 0, 0], [0, 4, 0], [0, 0, 2]]),
        ("pir", [[0, 0, 2], [-3, 0, 0], [0, -4, 0]]),
    ):
        volume = readVolume(path, letters)
        assert np.array_equal(volume.values, VALUES)
        assert np.allclose(volume.ijkToRas[:3, :3], columns)
        middle = volume.ijkToRas @ [2.0, 2.5, 3.0, 1.0]
        assert np.allclose(middle[:3], 0.0)
    with pytest.raises(InputError, match="must be three letters"):
        readVolume(path, "LRS")


@pytest.mark.parametrize("name", ["codes.nii", "bare.nrrd", "Analyze"])
def test_slicer_gives_no_orientation_to_a_file_that_states_none(tmp_path, scene, name):
    node = add_volume(scene, Volume(VALUES, np.eye(4)), "MRI")
    storage = scene.AddNewNodeByClass("vtkMRMLVolumeArchetypeStorageNode")
    storage.SetFileName(str(unplaced(tmp_path, name)))
    node.SetAndObserveStorageNodeID(storage.GetID())
    with pytest.raises(InputError, match="The file of the volume MRI does not state"):
        imageOfNode(node)
    # As Slicer does when a user saves it.
    saved = write_volume(tmp_path / "saved.nrrd", Volume(VALUES, np.eye(4)))
    storage.SetFileName(str(saved))
    assert imageOfNode(node).values.shape == SHAPE


@pytest.mark.parametrize("order", "<>")
@pytest.mark.parametrize("codes", [(0, 1), (0, 4), (1, 0)], ids=["sform", "atlas", "qform"])
def test_a_file_with_an_orientation_is_read_as_it_says(tmp_path, order, codes):
    path = tmp_path / "head.nii"
    path.write_bytes(nifti(codes=codes, order=order))
    volume = readVolume(path)
    expected = np.array(SFORM)[:, :3] if codes[1] else np.diag([3.0, 4.0, 2.0])
    assert np.allclose(volume.ijkToRas[:3, :3], expected)
    assert np.array_equal(volume.values, VALUES)
