"""Read a volume from a file such as NRRD or NIfTI, or from a folder of DICOM files."""

from __future__ import annotations

import gzip
import math
import os
import struct
import zlib
from pathlib import Path

import slicer

from rastrainer.errors import InputError
from rastrainer.slicer.head.volume import Volume, volumeFromNode
from rastrainer_headless.dicom_series import readDicomFolder

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
