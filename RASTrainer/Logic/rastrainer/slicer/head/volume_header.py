"""Whether a volume's file states how the patient lies.

Readers give an orientation to every volume, also where its file states none.
"""

from __future__ import annotations

import gzip
import zlib
from pathlib import Path
from typing import Any

import numpy as np

_READ_BYTES = 4096
_HEADER_SIZE = 348
_FIELDS = {
    "size": ("i4", 0),
    "sizes": ("8i2", 40),
    "kind": ("i2", 70),
    "bits": ("i2", 72),
    "spacing": ("4f4", 76),
    "begins": ("f4", 108),
    "codes": ("2i2", 252),
    "rotation": ("3f4", 256),
    "sform": ("(3,4)f4", 280),
    "magic": ("S4", 344),
}
_FORMATS, _OFFSETS = zip(*_FIELDS.values(), strict=True)
_NIFTI = np.dtype(
    {
        "names": list(_FIELDS),
        "formats": list(_FORMATS),
        "offsets": list(_OFFSETS),
        "itemsize": _HEADER_SIZE,
    }
)
"""The header of NIfTI-1 (nifti1.h), or of Analyze 7.5, which knows no orientation.

`sizes` begin with their number, `spacing` with the sign of the last axis of the qform; `codes` are
of qform and sform, 0 for none; `rotation` is b, c, d of the qform's quaternion.
"""
_PICTURES = (b"\x89PNG", b"\xff\xd8\xff", b"BM", b"II*\0", b"MM\0*", b"# vtk")
"""How files begin that never state an orientation."""


def missingOrientation(path: Path) -> str:
    """Return why a file says nothing of where the patient's left and front are; empty if it does.

    A file that is not there any more is not doubted.
    """
    begin = beginOf(path)
    nifti = niftiHeader(begin)
    if nifti is not None and isAnalyze(nifti):
        return "Analyze files have none"
    if nifti is not None and not nifti["codes"].any():
        return "its qform_code and sform_code are 0"
    if begin.startswith(b"NRRD") and not {"space", "space directions"} <= nrrdFields(begin).keys():
        return "it has no space directions"
    if b"ObjectType" in begin[:200] and not any(
        name in begin for name in (b"\nTransformMatrix =", b"\nOrientation =", b"\nRotation =")
    ):
        return "it has no TransformMatrix"
    return "it is a picture" if begin.startswith(_PICTURES) else ""


def beginOf(path: Path) -> bytes:
    """Return the first bytes of a file, or of an image's separate header; unpacked."""
    beside = path.with_suffix(".hdr")
    path = beside if path.suffix == ".img" and beside.is_file() else path
    try:
        with path.open("rb") as file:
            begin = file.read(_READ_BYTES)
            if begin.startswith(b"\x1f\x8b"):
                file.seek(0)
                with gzip.open(file) as unpacked:
                    begin = unpacked.read(_READ_BYTES)
    except (OSError, EOFError, zlib.error):
        return b""
    return begin


def niftiHeader(begin: bytes) -> Any | None:
    """Return a record of `_NIFTI`, of either order of bytes; None for other files."""
    for kind in (_NIFTI.newbyteorder("<"), _NIFTI.newbyteorder(">")):
        if len(begin) >= _HEADER_SIZE:
            header = np.frombuffer(begin, kind, 1)[0]
            if header["size"] == _HEADER_SIZE:
                return header
    return None


def isAnalyze(header: Any) -> bool:
    return header["magic"][:3] not in (b"n+1", b"ni1")


def nrrdFields(begin: bytes) -> dict[str, str]:
    header, _, _ = begin.replace(b"\r\n", b"\n").partition(b"\n\n")
    lines = [line.partition(":") for line in header.decode("latin-1").split("\n")]
    return {
        name.strip().lower(): value.strip()
        for name, separator, value in lines
        if separator and not name.startswith("#") and not value.startswith("=")
    }
