"""Read a volume from a file such as NRRD or NIfTI, or from a folder of DICOM files."""

from __future__ import annotations

import gzip
import math
import os
import struct
import zlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import slicer
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.slicer.head.volume import Volume, matrixOf, volumeFromNode

_HEADER_SIZE = 348
_DIMENSIONS, _BITS, _IMAGE_BEGINS = 40, 72, 108
"""Where the header of NIfTI-1 (nifti1.h) has `dim`, `bitpix` and `vox_offset`."""


def readAnyVolume(path: Path) -> Volume:
    """Read an NRRD or NIfTI file, or a folder with a DICOM series.

    Raises:
        InputError: it cannot be read.
    """
    return readDicomFolder(path) if Path(path).is_dir() else readVolume(path)


def readVolume(path: Path) -> Volume:
    """Read a volume of any format that Slicer's volume reader knows, such as NRRD or NIfTI.

    Raises:
        InputError: the file is missing or is no such volume.
    """
    if not Path(path).is_file():
        raise InputError(f"{path} does not exist; give a volume such as a .nii.gz or .nrrd file.")
    if str(path).endswith((".nii", ".nii.gz")) and _isCutNifti(path):
        raise InputError(f"{path} is cut short; copy the file again.")
    scene = slicer.vtkMRMLScene()
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    storage = slicer.vtkMRMLVolumeArchetypeStorageNode()
    storage.SetFileName(str(path))
    if not storage.ReadData(node) or node.GetImageData() is None:
        raise InputError(f"{path} could not be read as a volume such as NIfTI or NRRD.")
    return volumeFromNode(node)


def _isCutNifti(path: Path) -> bool:
    """Return whether a `.nii` or `.nii.gz` file ends too early; False for any other file."""
    opened = gzip.open if path.suffix == ".gz" else open
    try:
        with opened(path, "rb") as file:
            header = file.read(_HEADER_SIZE)
            return file.seek(0, os.SEEK_END) < _niftiSize(header)
    except (EOFError, zlib.error):
        return True
    except OSError:
        return False


def _niftiSize(header: bytes) -> float:
    """Return the least number of bytes of a NIfTI-1 file; 0 if it is none."""
    for order in "<>":
        if len(header) == _HEADER_SIZE and struct.unpack_from(f"{order}i", header)[0] == len(
            header
        ):
            count, *sizes = struct.unpack_from(f"{order}8h", header, _DIMENSIONS)
            (bits,) = struct.unpack_from(f"{order}h", header, _BITS)
            (begins,) = struct.unpack_from(f"{order}f", header, _IMAGE_BEGINS)
            return begins + math.prod(sizes[: max(0, count)]) * bits / 8
    return 0.0


MAX_FILES = 4000
MAX_BYTES = 2_000_000_000
FEWEST_SLICES = 8
EVEN_WITHIN = 0.1
"""Share of a step by which steps may differ; more means that a slice is missing."""

_SERIES_TAG = "0020|000e"


@dataclass(frozen=True)
class _Slice:
    """One file: values (i, j) and IJKToRAS (4, 4)."""

    values: np.ndarray
    ijkToRas: np.ndarray


def readDicomFolder(folder: Path) -> Volume:
    """Read the series with the most slices in a folder.

    Raises:
        InputError: there is none, or slices of it are missing or do not fit together.
    """
    paths = [path for path in sorted(folder.iterdir()) if _isDicom(path)]
    if not paths:
        raise InputError(f"The folder {folder} contains no DICOM files.")
    if len(paths) > MAX_FILES or sum(path.stat().st_size for path in paths) > MAX_BYTES:
        raise InputError(f"The folder {folder} contains more DICOM files than one head needs.")
    series: dict[str, list[_Slice]] = {}
    for path in paths:
        uid, image = _readSlice(path)
        series.setdefault(uid, []).append(image)
    largest = max(series.values(), key=len)
    if len(largest) < FEWEST_SLICES:
        raise InputError(
            f"The folder {folder} has no series of at least {FEWEST_SLICES} slices of one image."
        )
    return _stacked(folder, largest)


def _isDicom(path: Path) -> bool:
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(132)[128:] == b"DICM"


def _readSlice(path: Path) -> tuple[str, _Slice]:
    if isCutDicom(path):
        raise InputError(f"The DICOM file {path} is cut short or damaged; copy the series again.")
    reader = slicer.vtkITKArchetypeImageSeriesScalarReader()
    reader.SetArchetype(str(path))
    reader.SetSingleFile(1)
    reader.SetUseOrientationFromFile(1)
    reader.SetUseNativeOriginOn()
    reader.SetOutputScalarTypeToNative()
    reader.Update()
    image = reader.GetOutput()
    scalars = image.GetPointData().GetScalars()
    if reader.GetErrorCode() or scalars is None or image.GetDimensions()[2] != 1:
        raise InputError(f"The DICOM file {path} could not be read as one slice of an image.")
    if scalars.GetNumberOfComponents() != 1:
        raise InputError(f"The DICOM file {path} holds a color picture, not a slice.")
    ijkToRas = vtk.vtkMatrix4x4()
    vtk.vtkMatrix4x4.Invert(reader.GetRasToIjkMatrix(), ijkToRas)
    width, height, _one = image.GetDimensions()
    values = vtk_to_numpy(scalars).reshape(height, width).T.astype(np.float32)
    return reader.GetTagValue(_SERIES_TAG), _Slice(values, matrixOf(ijkToRas))


def _stacked(folder: Path, slices: list[_Slice]) -> Volume:
    first = slices[0].ijkToRas
    for other in slices:
        isParallel = np.allclose(other.ijkToRas[:3, :2], first[:3, :2], atol=1e-4)
        if not isParallel or other.values.shape != slices[0].values.shape:
            raise InputError(f"The slices of the DICOM series in {folder} do not fit together.")
    normal = np.cross(first[:3, 0], first[:3, 1])
    normal /= np.linalg.norm(normal)
    slices = sorted(slices, key=lambda image: float(normal @ image.ijkToRas[:3, 3]))
    places = np.array([image.ijkToRas[:3, 3] for image in slices])
    steps = np.diff(places @ normal)
    step = float(np.median(steps))
    if step <= 0 or np.abs(steps - step).max() > EVEN_WITHIN * step:
        raise InputError(
            f"The slices of the DICOM series in {folder} are not evenly spaced: some are missing "
            "or duplicated."
        )
    matrix = first.copy()
    matrix[:3, 2] = (places[-1] - places[0]) / (len(slices) - 1)
    matrix[:3, 3] = places[0]
    return Volume(np.stack([image.values for image in slices], axis=2), matrix)


_PIXEL_DATA = b"\xe0\x7f\x10\x00"
_UNDEFINED_LENGTH = 0xFFFFFFFF
_ITEM_GROUP, _SEQUENCE_DELIMITER = b"\xfe\xff", b"\xfe\xff\xdd\xe0"
_META_GROUP, _TRANSFER_SYNTAX = b"\x02\x00", b"\x02\x00\x10\x00"
_FIRST_ELEMENT = 132
_IMPLICIT = b"1.2.840.10008.1.2"
"""Prefix of all transfer syntaxes."""
_NOT_FOLLOWED = (b"1.2.840.10008.1.2.1.99", b"1.2.840.10008.1.2.2")
"""Deflated and big-endian data sets."""
_SHORT_KINDS = b"AE AS AT CS DA DS DT FL FD IS LO LT PN SH SL SS ST TM UI UL US".split()
_LONG_KINDS = b"OB OD OF OL OV OW SV UC UN UR UT UV".split()
_SEQUENCE = b"SQ"
"""Value representations: lengths of two and of four bytes (PS3.5, 7.1.2)."""


def isCutDicom(path: Path) -> bool:
    """Return whether a DICOM file is shorter than it claims (PS3.5, 7.1, 7.5 and A.4).

    Readers ask for as much memory as an element says it has: 4 GB for a few odd bytes.
    """
    content = path.read_bytes()
    return not _elementsFit(content) or _arePixelsCut(content)


def _elementsFit(content: bytes) -> bool:
    """Return whether each element that can be followed ends within the file.

    Sequences and their items are entered. Pixels in pieces, big-endian and deflated data sets and
    what is no data set are not followed.
    """
    at, syntax = _FIRST_ELEMENT, b""
    while at + 8 <= len(content):
        isMeta = content.startswith(_META_GROUP, at)
        if not isMeta and (syntax in _NOT_FOLLOWED or not syntax.startswith(_IMPLICIT)):
            return True
        begin, length, isEntered = _element(content, at, isMeta or syntax != _IMPLICIT)
        if begin == at:
            return not isMeta
        if length == _UNDEFINED_LENGTH and content.startswith(_PIXEL_DATA, at):
            return True
        if isEntered or length == _UNDEFINED_LENGTH:
            at = begin
            continue
        if begin + length > len(content):
            return False
        if content.startswith(_TRANSFER_SYNTAX, at):
            syntax = content[begin : begin + length].rstrip(b"\0 ")
        at = begin + length
    return True


def _element(content: bytes, at: int, isExplicit: bool) -> tuple[int, int, bool]:
    """Return where an element's value begins, its length, and whether elements are in it.

    An element of unknown kind, where the kind is required, begins where its value does.
    """
    kind = content[at + 4 : at + 6]
    if content.startswith(_ITEM_GROUP, at) or not isExplicit:
        (length,) = struct.unpack_from("<I", content, at + 4)
        return at + 8, length, content.startswith(_ITEM_GROUP, at)
    if kind in _SHORT_KINDS:
        (length,) = struct.unpack_from("<H", content, at + 6)
        return at + 8, length, False
    if (kind in _LONG_KINDS or kind == _SEQUENCE) and at + 12 <= len(content):
        (length,) = struct.unpack_from("<I", content, at + 8)
        return at + 12, length, kind == _SEQUENCE
    return at, 0, False


def _arePixelsCut(content: bytes) -> bool:
    begin = content.rfind(_PIXEL_DATA) + len(_PIXEL_DATA)
    if begin < len(_PIXEL_DATA):
        return False
    # With an explicit kind, its two bytes and two reserved ones precede the length.
    begin += 4 if content[begin : begin + 2] in (b"OB", b"OW") else 0
    if begin + 4 > len(content):
        return True
    (length,) = struct.unpack_from("<I", content, begin)
    if length == _UNDEFINED_LENGTH:
        return _SEQUENCE_DELIMITER not in content[begin:]
    return begin + 4 + length > len(content)
