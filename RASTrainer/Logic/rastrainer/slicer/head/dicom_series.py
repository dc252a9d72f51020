"""Read a folder of DICOM files as one volume, its slices in the order of their positions."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import slicer
import vtk
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.errors import InputError
from rastrainer.slicer.head.cut_files import is_cut_dicom
from rastrainer.slicer.head.volume import Volume, matrix_of

MOST_FILES = 4000
MOST_BYTES = 2_000_000_000
FEWEST_SLICES = 8
EVEN_WITHIN = 0.1
"""Steps between slices may differ by so much of a step: more means that one is missing."""

_SERIES_TAG = "0020|000e"


@dataclass(frozen=True)
class _Slice:
    """One file: values (i, j) and IJKToRAS (4, 4) of its own."""

    values: np.ndarray
    ijk_to_ras: np.ndarray


def read_dicom_folder(folder: Path) -> Volume:
    """Read the series with the most slices in a folder.

    Raises:
        InputError: there is none, or slices of it are missing or do not fit together.
    """
    paths = [path for path in sorted(folder.iterdir()) if _is_dicom(path)]
    if not paths:
        raise InputError(f"The folder {folder} holds no DICOM files.")
    if len(paths) > MOST_FILES or sum(path.stat().st_size for path in paths) > MOST_BYTES:
        raise InputError(f"The folder {folder} holds more than one head's worth of DICOM files.")
    series: dict[str, list[_Slice]] = {}
    for path in paths:
        uid, image = _read_slice(path)
        series.setdefault(uid, []).append(image)
    largest = max(series.values(), key=len)
    if len(largest) < FEWEST_SLICES:
        raise InputError(
            f"The folder {folder} has no series of at least {FEWEST_SLICES} slices of one image."
        )
    return _stacked(folder, largest)


def _is_dicom(path: Path) -> bool:
    if not path.is_file():
        return False
    with path.open("rb") as file:
        return file.read(132)[128:] == b"DICM"


def _read_slice(path: Path) -> tuple[str, _Slice]:
    if is_cut_dicom(path):
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
    ijk_to_ras = vtk.vtkMatrix4x4()
    vtk.vtkMatrix4x4.Invert(reader.GetRasToIjkMatrix(), ijk_to_ras)
    width, height, _one = image.GetDimensions()
    values = vtk_to_numpy(scalars).reshape(height, width).T.astype(np.float32)
    return reader.GetTagValue(_SERIES_TAG), _Slice(values, matrix_of(ijk_to_ras))


def _stacked(folder: Path, slices: list[_Slice]) -> Volume:
    first = slices[0].ijk_to_ras
    for other in slices:
        is_parallel = np.allclose(other.ijk_to_ras[:3, :2], first[:3, :2], atol=1e-4)
        if not is_parallel or other.values.shape != slices[0].values.shape:
            raise InputError(f"The slices of the DICOM series in {folder} do not fit together.")
    normal = np.cross(first[:3, 0], first[:3, 1])
    normal /= np.linalg.norm(normal)
    slices = sorted(slices, key=lambda image: float(normal @ image.ijk_to_ras[:3, 3]))
    places = np.array([image.ijk_to_ras[:3, 3] for image in slices])
    steps = np.diff(places @ normal)
    step = float(np.median(steps))
    if step <= 0 or np.abs(steps - step).max() > EVEN_WITHIN * step:
        raise InputError(
            f"The slices of the DICOM series in {folder} are not evenly spaced: some are missing "
            "or there twice."
        )
    matrix = first.copy()
    matrix[:3, 2] = (places[-1] - places[0]) / (len(slices) - 1)
    matrix[:3, 3] = places[0]
    return Volume(np.stack([image.values for image in slices], axis=2), matrix)
