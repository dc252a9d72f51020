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

_PIXEL_DATA, _LONG_KINDS = b"\xe0\x7f\x10\x00", (b"OB", b"OW")
_UNDEFINED_LENGTH = 0xFFFFFFFF
_SEQUENCE_DELIMITER = b"\xfe\xff\xdd\xe0"


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
    """Tell whether a DICOM file ends before its pixels do (PS3.5, 7.1 and A.4)."""
    content = path.read_bytes()
    begin = content.rfind(_PIXEL_DATA) + len(_PIXEL_DATA)
    if begin < len(_PIXEL_DATA):
        return False
    # With its kind told, two bytes of it and two of nothing come before the length.
    begin += 4 if content[begin : begin + 2] in _LONG_KINDS else 0
    if begin + 4 > len(content):
        return True
    (length,) = struct.unpack_from("<I", content, begin)
    if length == _UNDEFINED_LENGTH:
        return _SEQUENCE_DELIMITER not in content[begin:]
    return begin + 4 + length > len(content)
