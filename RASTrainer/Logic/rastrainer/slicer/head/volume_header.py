"""What the header of a volume's file says: whether it can be used, and how the patient lies.

Readers give an orientation to every volume, also where its file states none.
"""

from __future__ import annotations

import gzip
import math
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rastrainer.errors import InputError

_READ_BYTES = 4096
_NIFTI_2, _MGH = 540, b"\0\0\0\1"
_HEADER_SIZE = 348
_COLORS, _COMPLEX = (128, 2304), (32, 1792, 2048)
_PICTURES = (b"\x89PNG", b"\xff\xd8\xff", b"BM", b"II*\0", b"MM\0*", b"# vtk")
"""How files begin that never state an orientation."""

_RIGHT_ANGLE = 0.01
_LONGEST_ROTATION = 1.001
_CONTRADICTION = 0.7
"""Cosine of the angle between an axis by the qform and by the sform: they differ by 45°."""


@dataclass(frozen=True)
class _Nifti:
    """The header of NIfTI-1, or of Analyze 7.5, which knows no orientation (nifti1.h).

    `codes` are of qform and sform, 0 for none; `rotation` is b, c, d of the qform's quaternion,
    `flip` of its last axis, 1 or −1.
    """

    isAnalyze: bool
    sizes: tuple[int, ...]
    kind: int
    bits: int
    begins: float
    spacing: np.ndarray
    codes: tuple[int, int]
    rotation: np.ndarray
    flip: float
    sform: np.ndarray

    @property
    def qform(self) -> np.ndarray:
        """(3, 3) float: the rotation of the axes and the flip of the last one."""
        b, c, d = self.rotation
        a = math.sqrt(max(0.0, 1.0 - b * b - c * c - d * d))
        rotation = np.array(
            [
                [a * a + b * b - c * c - d * d, 2 * (b * c - a * d), 2 * (b * d + a * c)],
                [2 * (b * c + a * d), a * a + c * c - b * b - d * d, 2 * (c * d - a * b)],
                [2 * (b * d - a * c), 2 * (c * d + a * b), a * a + d * d - c * c - b * b],
            ]
        )
        return rotation @ np.diag([1.0, 1.0, self.flip])


def checkHeader(path: Path) -> None:
    begin = _begin(path)
    if path.suffix.lower() in (".mgz", ".mgh") or begin.startswith(_MGH):
        raise _unusable(path, "is in FreeSurfer's format", "mri_convert makes NIfTI of it")
    if begin[:4] in (struct.pack("<i", _NIFTI_2), struct.pack(">i", _NIFTI_2)):
        raise _unusable(path, "is NIfTI-2", "save it as NIfTI-1 or NRRD")
    if begin.startswith(b"NRRD"):
        fields = _nrrd(begin)
        sizes = [int(size) for size in fields.get("sizes", "").split() if size.isdecimal()]
        kinds = fields.get("kinds", "").lower()
        if len(sizes) == 4 and any(kind in kinds for kind in ("color", "vector", "complex")):
            several = f"has {fields['sizes']} values, several in a voxel"
            raise _unusable(path, several, "use one with gray values")
        _checkSizes(path, tuple(sizes))
    nifti = _nifti(begin)
    if nifti is not None:
        _checkNifti(path, nifti)


def missingOrientation(path: Path) -> str:
    """Return why a file says nothing of where the patient's left and front are; empty if it does.

    A file that is not there any more is not doubted.
    """
    begin = _begin(path)
    nifti = _nifti(begin)
    if nifti is not None and nifti.isAnalyze:
        return "Analyze files have none"
    if nifti is not None and nifti.codes == (0, 0):
        return "its qform_code and sform_code are 0"
    if begin.startswith(b"NRRD") and not {"space", "space directions"} <= _nrrd(begin).keys():
        return "it has no space directions"
    if b"ObjectType" in begin[:200] and not any(
        name in begin for name in (b"\nTransformMatrix =", b"\nOrientation =", b"\nRotation =")
    ):
        return "it has no TransformMatrix"
    return "it is a picture" if begin.startswith(_PICTURES) else ""


def leastSize(path: Path) -> float:
    """Return the least number of bytes, unpacked, of a NIfTI-1 file; 0 for any other file."""
    nifti = _nifti(_begin(path))
    if nifti is None or nifti.isAnalyze or path.suffix in (".hdr", ".img"):
        return 0.0
    return nifti.begins + math.prod(nifti.sizes) * nifti.bits / 8


def _begin(path: Path) -> bytes:
    """Return the first bytes of a file, or of the header beside an image; unpacked."""
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


def _nifti(begin: bytes) -> _Nifti | None:
    for order in "<>":
        if len(begin) < _HEADER_SIZE or struct.unpack_from(f"{order}i", begin)[0] != _HEADER_SIZE:
            continue
        count, *sizes = struct.unpack_from(f"{order}8h", begin, 40)
        kind, bits = struct.unpack_from(f"{order}2h", begin, 70)
        flip, *spacing = struct.unpack_from(f"{order}4f", begin, 76)
        return _Nifti(
            begin[344:347] not in (b"n+1", b"ni1"),
            tuple(sizes[: max(0, count)]),
            kind,
            bits,
            struct.unpack_from(f"{order}f", begin, 108)[0],
            np.array(spacing),
            struct.unpack_from(f"{order}2h", begin, 252),
            np.array(struct.unpack_from(f"{order}3f", begin, 256)),
            -1.0 if flip < 0 else 1.0,
            np.array(struct.unpack_from(f"{order}12f", begin, 280)).reshape(3, 4)[:, :3],
        )
    return None


def _checkNifti(path: Path, nifti: _Nifti) -> None:
    _checkSizes(path, nifti.sizes)
    if nifti.kind in _COLORS:
        raise _unusable(path, "has colors (RGB)", "use the image with one gray value a voxel")
    if nifti.kind in _COMPLEX:
        raise _unusable(path, "has complex numbers", "use the magnitude")
    if nifti.isAnalyze or nifti.codes == (0, 0):
        return
    repair = "write the orientation again from the original DICOM files"
    qformCode, sformCode = nifti.codes
    isLong = not np.linalg.norm(nifti.rotation) <= _LONGEST_ROTATION
    if qformCode > 0 and (isLong or not (nifti.spacing > 0).all()):
        raise _unusable(path, "has a qform that is no rotation", repair)
    if sformCode <= 0:
        return
    lengths = np.linalg.norm(nifti.sform, axis=0)
    if not np.isfinite(lengths).all() or not lengths.all():
        raise _unusable(path, "has an sform whose axes have no length", repair)
    axes = nifti.sform / lengths
    isSheared = np.abs(axes.T @ axes - np.eye(3)).max() > _RIGHT_ANGLE
    if isSheared and qformCode <= 0:
        raise _unusable(
            path, "has a sheared sform: its axes are not at right angles", "resample it"
        )
    if qformCode > 0 and np.sum(axes * nifti.qform, axis=0).min() < _CONTRADICTION:
        raise _unusable(
            path,
            f"has a qform and an sform that contradict each other ({_letters(nifti.qform)} and "
            f"{_letters(axes)})",
            "remove the wrong one",
        )


def _letters(axes: np.ndarray) -> str:
    """Return the directions, such as LPS, in which a volume's axes (3, 3) mostly run."""
    main = np.abs(axes).argmax(axis=0)
    return "".join(("RAS" if axes[row, i] > 0 else "LPI")[row] for i, row in enumerate(main))


def _nrrd(begin: bytes) -> dict[str, str]:
    header, _, _ = begin.replace(b"\r\n", b"\n").partition(b"\n\n")
    lines = [line.partition(":") for line in header.decode("latin-1").split("\n")]
    return {
        name.strip().lower(): value.strip()
        for name, separator, value in lines
        if separator and not name.startswith("#") and not value.startswith("=")
    }


def _checkSizes(path: Path, sizes: tuple[int, ...]) -> None:
    if math.prod(sizes[3:]) > 1:
        raise _unusable(
            path,
            f"has {len(sizes)} dimensions ({' × '.join(map(str, sizes))})",
            "extract one 3D image of it",
        )


def _unusable(path: Path, what: str, remedy: str) -> InputError:
    return InputError(f"{path} {what}; {remedy}.")
