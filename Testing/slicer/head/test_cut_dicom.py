"""A DICOM file that announces more than it has is refused before a reader asks for the memory."""

import struct
import tracemalloc

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer_headless.dicom_series import readDicom
from Testing.slicer.head.dicom_series import slice_file


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
        pytest.param(SLICE[:132] + b"\x02\x00garbage" * 40, id="an odd kind in the meta group"),
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
