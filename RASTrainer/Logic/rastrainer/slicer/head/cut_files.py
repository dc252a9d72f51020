"""Does a file end before its image does? Slicer's readers fill the rest of a NIfTI or DICOM image.

A head made of such an image would lack a part without anybody being told.
"""

from __future__ import annotations

import gzip
import math
import os
import struct
import zlib
from pathlib import Path

_HEADER_SIZE = 348
_DIMENSIONS, _BITS, _IMAGE_BEGINS = 40, 72, 108
"""Where the header of NIfTI-1 (nifti1.h) has `dim`, `bitpix` and `vox_offset`."""

_PIXEL_DATA = b"\xe0\x7f\x10\x00"
_UNDEFINED_LENGTH = 0xFFFFFFFF
_ITEM_GROUP, _SEQUENCE_DELIMITER = b"\xfe\xff", b"\xfe\xff\xdd\xe0"
_META_GROUP, _TRANSFER_SYNTAX = b"\x02\x00", b"\x02\x00\x10\x00"
_FIRST_ELEMENT = 132
_IMPLICIT = b"1.2.840.10008.1.2"
"""With which all transfer syntaxes begin."""
_NOT_FOLLOWED = (b"1.2.840.10008.1.2.1.99", b"1.2.840.10008.1.2.2")
"""Deflated and big-endian data sets."""
_SHORT_KINDS = b"AE AS AT CS DA DS DT FL FD IS LO LT PN SH SL SS ST TM UI UL US".split()
_LONG_KINDS = b"OB OD OF OL OV OW SV UC UN UR UT UV".split()
_SEQUENCE = b"SQ"
"""Value representations: lengths of two and of four bytes (PS3.5, 7.1.2)."""


def is_cut_nifti(path: Path) -> bool:
    """Tell whether a `.nii` or `.nii.gz` file ends too early; of no NIfTI file nothing is told."""
    opened = gzip.open if path.suffix == ".gz" else open
    try:
        with opened(path, "rb") as file:
            header = file.read(_HEADER_SIZE)
            return file.seek(0, os.SEEK_END) < _nifti_size(header)
    except (EOFError, zlib.error):
        return True
    except OSError:
        return False


def _nifti_size(header: bytes) -> float:
    """Return how many bytes a NIfTI-1 file has at least, 0 where it is none."""
    for order in "<>":
        if len(header) == _HEADER_SIZE and struct.unpack_from(f"{order}i", header)[0] == len(
            header
        ):
            count, *sizes = struct.unpack_from(f"{order}8h", header, _DIMENSIONS)
            (bits,) = struct.unpack_from(f"{order}h", header, _BITS)
            (begins,) = struct.unpack_from(f"{order}f", header, _IMAGE_BEGINS)
            return begins + math.prod(sizes[: max(0, count)]) * bits / 8
    return 0.0


def is_cut_dicom(path: Path) -> bool:
    """Tell whether a DICOM file ends before what it announces (PS3.5, 7.1, 7.5 and A.4).

    Readers ask for as much memory as an element says it has: 4 GB for a few odd bytes.
    """
    content = path.read_bytes()
    return not _elements_fit(content) or _are_pixels_cut(content)


def _elements_fit(content: bytes) -> bool:
    """Tell whether each element ends within the file, as far as they can be followed.

    Sequences and their items are entered. Pixels in pieces, big-endian and deflated data sets and
    what is no data set are not followed.
    """
    at, syntax = _FIRST_ELEMENT, b""
    while at + 8 <= len(content):
        is_meta = content.startswith(_META_GROUP, at)
        if not is_meta and (syntax in _NOT_FOLLOWED or not syntax.startswith(_IMPLICIT)):
            return True
        begin, length, is_entered = _element(content, at, is_meta or syntax != _IMPLICIT)
        if begin == at:
            return not is_meta
        if length == _UNDEFINED_LENGTH and content.startswith(_PIXEL_DATA, at):
            return True
        if is_entered or length == _UNDEFINED_LENGTH:
            at = begin
            continue
        if begin + length > len(content):
            return False
        if content.startswith(_TRANSFER_SYNTAX, at):
            syntax = content[begin : begin + length].rstrip(b"\0 ")
        at = begin + length
    return True


def _element(content: bytes, at: int, is_explicit: bool) -> tuple[int, int, bool]:
    """Return where an element's value begins, its length, and whether elements are in it.

    The value of what has no known kind, where one must be told, begins where the element does.
    """
    kind = content[at + 4 : at + 6]
    if content.startswith(_ITEM_GROUP, at) or not is_explicit:
        (length,) = struct.unpack_from("<I", content, at + 4)
        return at + 8, length, content.startswith(_ITEM_GROUP, at)
    if kind in _SHORT_KINDS:
        (length,) = struct.unpack_from("<H", content, at + 6)
        return at + 8, length, False
    if (kind in _LONG_KINDS or kind == _SEQUENCE) and at + 12 <= len(content):
        (length,) = struct.unpack_from("<I", content, at + 8)
        return at + 12, length, kind == _SEQUENCE
    return at, 0, False


def _are_pixels_cut(content: bytes) -> bool:
    begin = content.rfind(_PIXEL_DATA) + len(_PIXEL_DATA)
    if begin < len(_PIXEL_DATA):
        return False
    # With its kind told, two bytes of it and two of nothing come before the length.
    begin += 4 if content[begin : begin + 2] in (b"OB", b"OW") else 0
    if begin + 4 > len(content):
        return True
    (length,) = struct.unpack_from("<I", content, begin)
    if length == _UNDEFINED_LENGTH:
        return _SEQUENCE_DELIMITER not in content[begin:]
    return begin + 4 + length > len(content)
