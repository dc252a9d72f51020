"""Volumes as NRRD files are written and read back, and malicious files are refused."""

import gzip
import tracemalloc

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.head.volume import MAX_FILE_BYTES, read_nrrd, write_nrrd

OBLIQUE = np.array([[0.6, -0.8, 0, -50], [0.8, 0.6, 0, 10], [0, 0, -1.5, 70], [0, 0, 0, 1.0]])


def grays(kind=np.uint8, shape=(5, 6, 7)):
    return np.random.default_rng(5).integers(0, 200, shape).astype(kind)


def good_file(values=None):
    """The fields and voxels of a valid file."""
    values = grays() if values is None else values
    fields = {
        "type": "uint8",
        "dimension": "3",
        "space": "left-posterior-superior",
        "sizes": " ".join(map(str, values.shape)),
        "space directions": "(1,0,0) (0,1,0) (0,0,1)",
        "endian": "little",
        "encoding": "gzip",
        "space origin": "(-10,-20,30)",
    }
    return fields, gzip.compress(values.tobytes(order="F"))


def write(path, fields, voxels, end="\n"):
    lines = ["NRRD0004", *(f"{name}: {value}" for name, value in fields.items())]
    path.write_bytes(end.join(lines).encode() + 2 * end.encode() + voxels)
    return path


def changed(path, voxels=None, **changes):
    """Write a file with changed fields, or without those that are None."""
    fields, good = good_file()
    fields |= {name.replace("_", " "): value for name, value in changes.items()}
    kept = {name: value for name, value in fields.items() if value is not None}
    return write(path, kept, good if voxels is None else voxels)


@pytest.mark.parametrize("kind", [np.uint8, np.int16])
@pytest.mark.parametrize("matrix", [np.diag([-1.0, -1, 1, 1]), np.eye(4), OBLIQUE])
def test_what_is_written_is_read_back(tmp_path, kind, matrix):
    values = grays(kind)
    values[1, 2, 3] = -100 if kind is np.int16 else 100
    write_nrrd(tmp_path / "a.nrrd", values, matrix)
    read, place = read_nrrd(tmp_path / "a.nrrd")
    assert read.dtype == values.dtype
    assert np.array_equal(read, values)
    assert np.array_equal(place, matrix)


def test_the_same_image_gives_the_same_bytes_without_further_metadata(tmp_path):
    for name in ("a.nrrd", "b.nrrd"):
        write_nrrd(tmp_path / name, grays(), np.eye(4))
    content = (tmp_path / "a.nrrd").read_bytes()
    assert content == (tmp_path / "b.nrrd").read_bytes()
    header = content.partition(b"\n\n")[0].decode()
    names = [line.partition(":")[0] for line in header.split("\n")[1:]]
    written = "type,dimension,space,sizes,space directions,kinds,endian,encoding,space origin"
    assert ",".join(names) == written


@pytest.mark.parametrize(
    ("space", "ras"),
    [
        ("left-posterior-superior", (10, 20, 30)),
        ("RAS", (-10, -20, 30)),
        ("left-anterior-superior", (10, -20, 30)),
    ],
)
def test_each_space_is_converted_to_ras(tmp_path, space, ras):
    _, matrix = read_nrrd(changed(tmp_path / "a.nrrd", space=space))
    assert matrix[:3, 3].tolist() == list(ras)


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"type": "float"}, "must have the type uint8"),
        ({"encoding": "raw"}, "compressed by gzip"),
        ({"sizes": "5 6 8"}, "cut short"),
        ({"space": "scanner-xyz"}, "space left-posterior-superior"),
        ({"sizes": "2000 2000 2000"}, "at most 50 million in all"),
        ({"sizes": "5 6 6"}, "no more voxels than its header says"),
        ({"space_directions": None}, "“space directions” with 9 numbers"),
        ({"space_directions": "(1,0,0) (0,1,0) (1,1,0)"}, "axes that span a space"),
        ({"space_directions": "(100,0,0) (0,1,0) (0,0,1)"}, "voxels of 0.1 to 10 mm"),
        ({"data_file": "/etc/passwd"}, "hold its voxels itself"),
        ({"SIZES": "5 6 7"}, "have the field “sizes” once"),
    ],
)
def test_an_unusable_header_is_refused_with_a_message(tmp_path, changes, sentence):
    path = changed(tmp_path / "bad.nrrd", **changes)
    with pytest.raises(InputError, match=sentence) as caught:
        read_nrrd(path)
    assert "bad.nrrd must " in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_header_that_claims_gigabytes_is_refused_before_allocation(tmp_path):
    bomb = gzip.compress(bytes(200_000_000), 1)
    many = changed(tmp_path / "many.nrrd", bomb, sizes="2048 2048 2048")
    few = changed(tmp_path / "few.nrrd", bomb, sizes="10 10 10")
    tracemalloc.start()
    try:
        for path in (many, few):
            with pytest.raises(InputError):
                read_nrrd(path)
        assert tracemalloc.get_traced_memory()[1] < MAX_FILE_BYTES + 1_000_000
    finally:
        tracemalloc.stop()
