"""Read the largest stack of slices among DICOM files: one series, sorted by place.

pydicom reads the headers and uncompressed pixels; Slicer's reader decompresses the rest.
"""

from __future__ import annotations

import io
import tempfile
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pydicom
import slicer
from pydicom.uid import MRImageStorage, RLELossless
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.slicer.head.volume import Volume

pydicom.config.settings.reading_validation_mode = pydicom.config.IGNORE

MAX_FILES = 20_000
MAX_BYTES = 2_000_000_000
FEWEST_SLICES = 8
EVEN_WITHIN = 0.1
"""Share of a step by which steps may differ; more means that a slice is missing."""

IN_LINE_WITHIN = 0.5
"""Share of a step by which a slice may lie off the line of the others."""

_SAME_AXES, _SAME_PLACE_MM = 1e-3, 0.01
_MAGIC_AT, _MAGIC = 128, b"DICM"
_FIRST_GROUPS = (b"\x08\x00", b"\x02\x00", b"\x00\x08")
"""How a file without preamble begins."""

_SERIES = ("SeriesInstanceUID", "Rows", "Columns", "ImageType", "EchoTime")
_NO_HEADS = ("PR", "REG", "RTDOSE", "SEG")
_LPS_TO_RAS = np.array([-1.0, -1.0, 1.0])
_DESCRIPTION = ("Rows", "Columns", "BitsAllocated", "BitsStored", "HighBit", "PixelRepresentation")


@dataclass(frozen=True)
class _Slice:
    """One slice, whose pixels are not read yet.

    `axes` (3, 2), RAS mm, lead from a pixel to the next one in its row and in its column; all
    slices of a stack share `series`.
    """

    path: Path
    frame: int
    series: tuple[str, ...]
    name: str
    axes: np.ndarray
    place: np.ndarray
    slope: float
    intercept: float


def isDicom(path: Path) -> bool:
    with path.open("rb") as file:
        begin = file.read(_MAGIC_AT + len(_MAGIC))
    return begin[_MAGIC_AT:] == _MAGIC or begin[:2] in _FIRST_GROUPS


def readDicom(path: Path) -> Volume:
    """Read the stack with the most slices in a folder and the folders in it, or in one file.

    Other files are ignored: reports, presentation states, directories, pictures.
    """
    paths = sorted(each for each in path.rglob("*") if each.is_file()) if path.is_dir() else [path]
    paths = [each for each in paths if isDicom(each)]
    if len(paths) > MAX_FILES:
        raise InputError(f"{path} contains more than {MAX_FILES} DICOM files; give one series.")
    if not paths:
        raise InputError(f"The folder {path} contains no DICOM files.")
    stacks: list[list[_Slice]] = []
    for each in (found for file in paths for found in _read(file, lambda f: list(_slices(f)))):
        alike = (stack for stack in stacks if stack[0].series == each.series)
        closeTo = partial(np.allclose, each.axes, atol=_SAME_AXES)
        stack = next((stack for stack in alike if closeTo(stack[0].axes)), [])
        if not stack:
            stacks.append(stack)
        stack.append(each)
    stacks.sort(key=len, reverse=True)
    if not stacks or len(stacks[0]) < FEWEST_SLICES:
        raise InputError(
            f"{path} has no series of at least {FEWEST_SLICES} slices of one image, side by side."
        )
    largest = stacks[0]
    count = sum(2 * len(stack) >= len(largest) for stack in stacks)
    note = (
        f"There are {count} series of many slices; the head was made from “{largest[0].name}” with "
        f"{len(largest)}. To use another one, give it alone."
    )
    return _stacked(path, largest, (note,) if count > 1 else ())


def _read(path: Path, read: Callable[[Path], Any]) -> Any:
    """Return the result of reading a file; pydicom raises many errors at damaged files."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return read(path)
    except (InputError, MemoryError):
        raise
    except Exception:
        raise InputError(
            f"The DICOM file {path} is cut short or damaged; copy the series again."
        ) from None


def _content(path: Path) -> bytes:
    """Return a file's bytes; from memory, an element that claims 4 GB gets what there is."""
    if path.stat().st_size > MAX_BYTES:
        raise InputError(f"The DICOM file {path} is larger than one head needs.")
    return path.read_bytes()


def _slices(path: Path) -> Iterator[_Slice]:
    """Yield the slices of a file; none if its image has no position in a patient."""
    content = _content(path)
    header = pydicom.dcmread(io.BytesIO(content), force=True)
    kind = header.get("SOPClassUID") or header.file_meta.get("MediaStorageSOPClassUID")
    if kind is None:
        if content[_MAGIC_AT:].startswith(_MAGIC):
            raise ValueError("no DICOM data set")
        return
    if "PixelData" not in header:
        if "Image Storage" in kind.name:
            raise ValueError("no pixels")
        return
    if header.get("Modality") in _NO_HEADS or header.get("SamplesPerPixel", 1) != 1:
        return
    shared = header.get("SharedFunctionalGroupsSequence") or [pydicom.Dataset()]
    frames = header.get("PerFrameFunctionalGroupsSequence") or [pydicom.Dataset()]
    for index, frame in enumerate(frames):
        groups = (frame, shared[0])
        direction = _value(header, groups, "PlaneOrientation", "ImageOrientationPatient")
        place = _value(header, groups, "PlanePosition", "ImagePositionPatient")
        spacing = _value(header, groups, "PixelMeasures", "PixelSpacing")
        slope = _value(header, groups, "PixelValueTransformation", "RescaleSlope")
        intercept = _value(header, groups, "PixelValueTransformation", "RescaleIntercept")
        if not (direction and place and spacing):
            continue
        axes = np.array(direction, float).reshape(2, 3).T * _LPS_TO_RAS[:, None]
        yield _Slice(
            path,
            index,
            tuple(str(header.get(key, "")) for key in _SERIES),
            "".join(filter(str.isprintable, str(header.get("SeriesDescription", ""))))[:64],
            axes * np.array(spacing, float)[::-1],
            np.array(place, float) * _LPS_TO_RAS,
            float(slope or 1.0),
            float(intercept or 0.0),
        )


def _value(header: Any, groups: tuple[Any, Any], group: str, name: str) -> Any:
    """Return a frame's value: from its functional groups, the shared groups, or the file."""
    for each in groups:
        items = each.get(f"{group}Sequence")
        if items and items[0].get(name) is not None:
            return items[0].get(name)
    return header.get(name)


def _stacked(folder: Path, slices: list[_Slice], notes: tuple[str, ...]) -> Volume:
    axes = slices[0].axes
    normal = np.cross(axes[:, 0], axes[:, 1])
    if not np.isfinite(normal).all() or not normal.any():
        raise InputError(f"The DICOM series in {folder} does not say where its slices lie.")
    normal /= np.linalg.norm(normal)
    slices = sorted(slices, key=lambda each: float(normal @ each.place))
    paths = {each.path for each in slices}
    if sum(path.stat().st_size for path in paths) > MAX_BYTES:
        raise InputError(f"The series {slices[0].name} is larger than one head needs.")
    numbers = {path: _read(path, _numbers) for path in paths}
    values = [
        numbers[each.path][each.frame].T.astype(np.float32) * np.float32(each.slope)
        + np.float32(each.intercept)
        for each in slices
    ]
    places = np.array([each.place for each in slices])
    isNew = np.append(True, np.diff(places @ normal) > _SAME_PLACE_MM)
    for index in np.flatnonzero(~isNew):
        if not np.array_equal(values[index], values[index - 1]):
            raise InputError(
                f"The DICOM series in {folder} has different images at the same place: several "
                "echoes, or a series over time. Give one image of each place."
            )
    values, places = [values[index] for index in np.flatnonzero(isNew)], places[isNew]
    steps = np.diff(places @ normal)
    step = float(np.median(steps)) if len(steps) else 0.0
    if step <= 0 or np.abs(steps - step).max() > EVEN_WITHIN * step:
        gap = f"{steps.min():.2f} to {steps.max():.2f} mm apart" if len(steps) else "at one place"
        raise InputError(
            f"The slices of the DICOM series in {folder} are not evenly spaced, but {gap}: some "
            "are missing."
        )
    matrix = np.eye(4)
    matrix[:3, :2] = axes
    matrix[:3, 2] = (places[-1] - places[0]) / (len(places) - 1)
    matrix[:3, 3] = places[0]
    line = places[0] + np.arange(len(places))[:, None] * matrix[:3, 2]
    if np.abs(places - line).max() > IN_LINE_WITHIN * step:
        raise InputError(f"The slices of the DICOM series in {folder} do not lie in one line.")
    return Volume(np.stack(values, axis=2), matrix, notes)


def _numbers(path: Path) -> np.ndarray:
    """Return the numbers (frames, rows, columns) of a file, as stored."""
    image = pydicom.dcmread(io.BytesIO(_content(path)), force=True)
    if "TransferSyntaxUID" not in image.file_meta:
        isImplicit, isLittle = image.original_encoding
        image.file_meta.TransferSyntaxUID = pydicom.uid.UID(
            "1.2.840.10008.1.2" + ("" if isImplicit else ".1" if isLittle else ".2")
        )
    syntax = image.file_meta.TransferSyntaxUID
    isCoded = syntax.is_compressed and syntax != RLELossless and not syntax.is_deflated
    numbers = _decompressed(image) if isCoded else image.pixel_array
    return numbers.reshape(-1, image.Rows, image.Columns)


def _decompressed(image: Any) -> np.ndarray:
    """Return the numbers of a file with JPEG or alike, by the reader of Slicer."""
    bare = pydicom.Dataset()
    bare.SOPClassUID, bare.SOPInstanceUID = MRImageStorage, pydicom.uid.generate_uid()
    bare.SamplesPerPixel, bare.PhotometricInterpretation = 1, "MONOCHROME2"
    for name in _DESCRIPTION:
        setattr(bare, name, getattr(image, name))
    bare.NumberOfFrames = image.get("NumberOfFrames", 1)
    bare.file_meta = pydicom.dataset.FileMetaDataset()
    bare.file_meta.TransferSyntaxUID = image.file_meta.TransferSyntaxUID
    bare["PixelData"] = image["PixelData"]
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "image.dcm"
        bare.save_as(path, enforce_file_format=True)
        reader = slicer.vtkITKArchetypeImageSeriesScalarReader(archetype=str(path), single_file=1)
        reader.SetOutputScalarTypeToNative()
        reader.SetDesiredCoordinateOrientationToNative()
        reader.Update()
        scalars = reader.GetOutput().GetPointData().GetScalars()
        if reader.GetErrorCode() or scalars is None:
            raise ValueError("not decoded")
        return vtk_to_numpy(scalars).copy()
