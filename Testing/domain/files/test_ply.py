"""PLY files that other programs write: any element, list, byte order and frame."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.files.ply import read_point_cloud, write_ply

POINTS = np.array([[1.5, -2.0, 3.25], [80.0, 0.125, -7.0], [-3.0, 40.0, 99.0]])
HEAD = "ply\nformat {form} 1.0\n{said}element vertex 3\nproperty float x\nproperty float y\n"
HEAD += "property float z\nend_header\n"


def cloud(path, content):
    path.write_bytes(content if isinstance(content, bytes) else content.encode("latin-1"))
    return read_point_cloud(path)


@pytest.mark.parametrize("ending", [b"\r\n", b"\n", b"\r"], ids=["CR LF", "LF", "CR"])
@pytest.mark.parametrize("first", [b"\r\n", b"\n", b"end_header\n\r\n"], ids=ascii)
def test_bytes_of_the_body_that_look_like_ends_of_lines_stay(tmp_path, ending, first):
    body = (first + POINTS.astype("<f8").tobytes()[len(first) :])[:72]
    write_ply(tmp_path / "a.ply", POINTS, "World")
    head = (tmp_path / "a.ply").read_bytes()[:-72].replace(b"\n", ending)
    read = cloud(tmp_path / "a.ply", head + body)
    np.testing.assert_array_equal(read, np.frombuffer(body, "<f8").reshape(3, 3))


def test_every_trace_that_was_written_is_read_to_the_last_bit(tmp_path):
    random = np.random.default_rng(0)
    for _ in range(60):
        points = random.normal(0.0, 100.0, (500, 3))
        write_ply(tmp_path / "a.ply", points, "World")
        np.testing.assert_array_equal(read_point_cloud(tmp_path / "a.ply"), points)


@pytest.mark.parametrize(
    ("said", "factors"),
    [
        ("comment 3D Slicer output. SPACE=LPS\n", [-1, -1, 1]),
        ("comment space=lps\ncomment mm\n", [-1, -1, 1]),
        ("comment 3D Slicer output. SPACE=RAS\n", [1, 1, 1]),
        ("comment SPACE=World\n", [1, 1, 1]),
        ("comment von Jürgen\nobj_info SPACE=LPS\n", [1, 1, 1]),
    ],
)
@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
def test_points_in_lps_become_ras_and_others_stay(tmp_path, said, factors, form):
    order = {"binary_little_endian": "<f4", "binary_big_endian": ">f4"}.get(form)
    rows = "".join(f"{x} {y} {z}\n" for x, y, z in POINTS).encode()
    body = POINTS.astype(order).tobytes() if order else rows
    read = cloud(tmp_path / "a.ply", HEAD.format(form=form, said=said).encode("latin-1") + body)
    np.testing.assert_array_equal(read, POINTS * factors)


LISTS = "ply\nformat binary_little_endian 1.0\nelement a {rows}\n"
LISTS += "property list {count} uchar b\nend_header\n"


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("x", "must be a PLY file"),
        ("ply\nformat ascii 1.0\nend_header\n", "must have vertices with x, y and z"),
        (HEAD.format(form="ascii", said="") + "1 2 3\n4 5 6\n", "cut short"),
        (HEAD.format(form="ascii", said="") + "1 2 3 " * 20_000, "cut short"),
        (HEAD.format(form="binary_little_endian", said="") + "x" * 37, "bytes left over"),
        (HEAD.format(form="ascii", said="").replace("x 3", "x 9999999"), "must be a PLY|more than"),
        (LISTS.format(rows=1, count="uint") + "\xff\xff\xff\xffabc", "cut short"),
        (LISTS.format(rows=2, count="uchar") + "\x01a\x09b", "cut short"),
        (LISTS.format(rows=4_000_001, count="uchar"), "more than 4000000 of its element a"),
    ],
)
def test_a_damaged_or_hostile_file_is_refused_in_one_sentence(tmp_path, content, said):
    with pytest.raises(InputError, match=said) as caught:
        cloud(tmp_path / "a.ply", content)
    assert "\n" not in str(caught.value)
