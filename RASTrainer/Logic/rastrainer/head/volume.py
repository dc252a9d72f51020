"""The images of a scenario's head, RAS mm, in an NRRD file: the part of the format that they need.

The format is Teem's "nearly raw raster data": text lines, an empty line, then the voxels. Supported
are three axes of gzip-compressed integers in a known space. The header is checked before the voxels
are unpacked; comments and key/value texts are ignored and never written.
"""

from __future__ import annotations

import gzip
import io
import math
import re
import zlib
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.reading import path_beside, read_bytes, relative_path
from rastrainer.files.writing import write_bytes
from rastrainer.head.mesh import HeadMesh
from rastrainer.json_checks import number

MAX_GRAY_LEVEL = 32768.0
"""Limit of window and level: the largest value of a volume."""

KEPT_MM = 6.0
"""Margin kept around the head; noise, a frame, text or a wrapped nose may lie beyond it."""

MIN_COVERED_SHARE = 0.5
"""Least share of the head's vertices within the images: scans often lack the nose and the ears."""


@dataclass(frozen=True)
class VolumeFile:
    """A scenario's volume, not read yet: an NRRD file.

    Values from `level` − `window` / 2 to `level` + `window` / 2 are shown from black to white.
    """

    file: Annotated[Path, relative_path]
    window: Annotated[float, number(1, 2 * MAX_GRAY_LEVEL)]
    level: Annotated[float, number(-MAX_GRAY_LEVEL, MAX_GRAY_LEVEL)]

    def located(self, scenario_file: Path) -> VolumeFile:
        """Return the volume with its whole path; `scenario_file` names it by `volume`."""
        return replace(self, file=path_beside(scenario_file, self.file, "volume.file"))


@dataclass(frozen=True)
class HeadVolume:
    """A scalar image of a head: values (i, j, k) uint8 or int16, index to RAS mm."""

    values: np.ndarray
    ijk_to_ras: np.ndarray
    window: float
    level: float


def read_head_volume(file: VolumeFile) -> HeadVolume:
    return HeadVolume(*read_nrrd(file.file), file.window, file.level)


def check_place(volume: HeadVolume, head: HeadMesh, path: Path) -> None:
    """Check that a volume covers its head."""
    indices = transforms.apply(transforms.inverse(volume.ijk_to_ras), head.vertices.astype(float))
    is_within = (indices >= -0.5) & (indices <= np.array(volume.values.shape) - 0.5)
    if is_within.all(axis=1).mean() < MIN_COVERED_SHARE:
        raise InputError(f"The volume {path} must lie where the head is.")


MAX_FILE_BYTES = 40_000_000
MAX_VOXELS = 50_000_000
MAX_AXIS_VOXELS = 2048
MAX_ORIGIN_MM = 2000.0
"""Distance of the first voxel from the origin, along each axis."""

SPACINGS_MM = (0.1, 10.0)
MIN_AXIS_VOLUME = 0.1
"""Least volume of the box spanned by unit steps along the axes; a smaller box has almost coplanar
axes."""

_MAGIC = re.compile(r"NRRD000[1-5]")
_MAX_HEADER_BYTES = 16_384
_KINDS = {
    "uint8": ("unsigned char", "uchar", "uint8", "uint8_t"),
    "int16": ("short", "short int", "signed short", "signed short int", "int16", "int16_t"),
}
_SPACES = {
    **dict.fromkeys(("left-posterior-superior", "lps"), (-1.0, -1.0, 1.0)),
    **dict.fromkeys(("left-anterior-superior", "las"), (-1.0, 1.0, 1.0)),
    **dict.fromkeys(("right-anterior-superior", "ras"), (1.0, 1.0, 1.0)),
}
"""Signs that convert to RAS."""

_ELSEWHERE = ("data file", "datafile", "line skip", "lineskip", "byte skip", "byteskip")
_VECTOR = re.compile(r"\(([^()]*)\)")


def read_nrrd(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the voxels (i, j, k), uint8 or int16, and the matrix (4, 4) float, index to RAS mm."""
    content = read_bytes(path, MAX_FILE_BYTES)
    start = content[:_MAX_HEADER_BYTES]
    blank_line = re.search(rb"\r?\n\r?\n", start)
    header = start[: blank_line.start()] if blank_line else start
    magic, *lines = header.decode("latin-1").replace("\r\n", "\n").split("\n")
    if not _MAGIC.fullmatch(magic):
        raise _wrong(path, "start as NRRD files do")
    if blank_line is None:
        raise _wrong(path, f"have a header of at most {_MAX_HEADER_BYTES // 1024} KiB")
    fields = _fields(path, lines)
    kind = fields.get("type", "").lower()
    name = next((name for name, words in _KINDS.items() if kind in words), None)
    if name is None:
        raise _wrong(path, "have the type uint8 (unsigned char) or int16 (short)")
    if fields.get("encoding", "").lower() not in ("gzip", "gz"):
        raise _wrong(path, "be compressed by gzip")
    endian = fields.get("endian", "little").lower()
    if endian not in ("little", "big"):
        raise _wrong(path, "be little or big endian")
    dtype = np.dtype(name).newbyteorder("<" if endian == "little" else ">")
    shape, matrix = _shape(path, fields), _matrix(path, fields)
    count = math.prod(shape) * dtype.itemsize
    stream = zlib.decompressobj(wbits=31)
    try:
        voxels = stream.decompress(content[blank_line.end() :], count + 1)
    except zlib.error:
        raise _wrong(path, "hold voxels that gzip can unpack: it is damaged") from None
    if len(voxels) > count:
        raise _wrong(path, "hold no more voxels than its header says")
    if len(voxels) < count or not stream.eof:
        raise _wrong(path, "hold as many voxels as its header says: it is cut short")
    values = np.frombuffer(voxels, dtype)
    native = values.astype(dtype.newbyteorder("="), copy=False)
    return native.reshape(shape, order="F"), matrix


def write_nrrd(path: Path, values: np.ndarray, ijk_to_ras: np.ndarray) -> None:
    """Write (i, j, k) uint8 or int16, gzip-compressed; the same image gives the same bytes."""
    to_lps = np.diag([*_SPACES["lps"], 1.0]) @ ijk_to_ras
    directions = " ".join(_vector(to_lps[:3, axis]) for axis in range(3))
    lines = (
        "NRRD0004",
        f"type: {_KINDS[values.dtype.name][0]}",
        "dimension: 3",
        "space: left-posterior-superior",
        f"sizes: {' '.join(map(str, values.shape))}",
        f"space directions: {directions}",
        "kinds: domain domain domain",
        "endian: little",
        "encoding: gzip",
        f"space origin: {_vector(to_lps[:3, 3])}",
    )
    packed = io.BytesIO()
    # Without the time and name that `gzip.open` would write.
    with gzip.GzipFile("", "wb", 9, packed, mtime=0) as file:
        file.write(values.astype(values.dtype.newbyteorder("<")).tobytes(order="F"))
    write_bytes(path, "\n".join(lines).encode("ascii") + b"\n\n" + packed.getvalue())


def _fields(path: Path, lines: list[str]) -> dict[str, str]:
    fields: dict[str, str] = {}
    for line in lines:
        name, separator, value = line.partition(":")
        # "#" starts a comment, "name:=value" is a key/value text.
        if line.startswith("#") or not separator or value.startswith("="):
            continue
        name = name.strip().lower()
        if name in fields:
            raise _wrong(path, f"have the field “{name[:40]}” once")
        fields[name] = value.strip()
    if any(name in fields for name in _ELSEWHERE):
        raise _wrong(path, "hold its voxels itself, right after its header")
    return fields


def _shape(path: Path, fields: dict[str, str]) -> tuple[int, int, int]:
    sizes = fields.get("sizes", "").split()
    is_whole = all(size.isascii() and size.isdigit() and len(size) < 6 for size in sizes)
    if fields.get("dimension") != "3" or len(sizes) != 3 or not is_whole:
        raise _wrong(path, "have three axes")
    i, j, k = map(int, sizes)
    shape = (i, j, k)
    if not all(2 <= size <= MAX_AXIS_VOXELS for size in shape) or math.prod(shape) > MAX_VOXELS:
        raise _wrong(
            path,
            f"have 2 to {MAX_AXIS_VOXELS} voxels along each axis and at most "
            f"{MAX_VOXELS // 10**6} million in all",
        )
    return shape


def _matrix(path: Path, fields: dict[str, str]) -> np.ndarray:
    signs = _SPACES.get(fields.get("space", "").lower())
    if signs is None:
        raise _wrong(path, "be in the space left-posterior-superior")
    axes = _vectors(path, fields, "space directions", 3)
    origin = _vectors(path, fields, "space origin", 1)[0]
    spacings = np.linalg.norm(axes, axis=1)
    if not (spacings >= SPACINGS_MM[0]).all() or not (spacings <= SPACINGS_MM[1]).all():
        raise _wrong(path, f"have voxels of {SPACINGS_MM[0]:g} to {SPACINGS_MM[1]:g} mm")
    if abs(np.linalg.det(axes / spacings[:, None])) < MIN_AXIS_VOLUME:
        raise _wrong(path, "have axes that span a space")
    # No negative zeros.
    return np.diag([*signs, 1.0]) @ transforms.rigid(axes.T, origin) + 0.0


def _vectors(path: Path, fields: dict[str, str], name: str, count: int) -> np.ndarray:
    """Return the vectors (count, 3) float of a field, such as `(1,0,0) (0,1,0) (0,0,1)`."""
    found = [each.split(",") for each in _VECTOR.findall(fields.get(name, ""))]
    try:
        vectors = np.array(found, dtype=float)
    except ValueError:
        vectors = np.empty(0)
    if vectors.shape != (count, 3) or not (np.abs(vectors) <= MAX_ORIGIN_MM).all():
        numbers = f"{3 * count} numbers within ±{MAX_ORIGIN_MM:g}"
        raise _wrong(path, f"have the field “{name}” with {numbers}")
    return vectors


def _vector(values: np.ndarray) -> str:
    return "(" + ",".join(f"{value + 0.0:.12g}" for value in values) + ")"


def _wrong(path: Path, wanted: str) -> InputError:
    return InputError(f"The volume {path} must {wanted}.")
