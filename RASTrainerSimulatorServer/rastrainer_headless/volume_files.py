"""Read a volume from a file such as NRRD or NIfTI, or from DICOM files."""

from __future__ import annotations

import gzip
import math
import os
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import slicer
import vtk
from scipy.spatial.transform import Rotation

from rastrainer.errors import InputError
from rastrainer.slicer.head import volume_header
from rastrainer.slicer.head.volume import Volume, asFloat, imageOfNode
from rastrainer_headless.dicom_series import isDicom, readDicom

_MGH = b"\0\0\0\1"
_COLORS, _COMPLEX = (128, 2304), (32, 1792, 2048)
_RIGHT_ANGLE = 0.01
_LONGEST_ROTATION = 1.001
_CONTRADICTION = 0.7
"""Cosine of the angle between an axis by the qform and by the sform: they differ by 45°."""


def readVolume(path: Path, orientation: str | None = None) -> Volume:
    """Read a file that Slicer's volume reader knows, such as NRRD, or a DICOM file or folder.

    `orientation`, such as LAS, is for a file that states none.
    """
    if path.is_dir() or (path.is_file() and isDicom(path)):
        return readDicom(path)
    if not path.is_file():
        raise InputError(f"{path} does not exist; give a volume such as a .nii.gz or .nrrd file.")
    nifti = volume_header.niftiHeader(path)
    _checkHeader(path, nifti)
    if _isCutShort(path, nifti):
        raise InputError(f"{path} is cut short; copy the file again.")
    missing = volume_header.missingOrientation(path)
    if missing and orientation is None:
        raise InputError(
            f"{path} does not state the patient's orientation ({missing}): left and right, front "
            "and back are unknown. Where you know how its axes run, say so: --orientation LAS is "
            "left, anterior, superior."
        )
    scene = slicer.vtkMRMLScene()
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    storage = slicer.vtkMRMLVolumeArchetypeStorageNode(file_name=str(path))
    if not storage.ReadData(node) or node.GetImageData() is None:
        raise InputError(f"{path} could not be read as a volume such as NIfTI or NRRD.")
    volume = asFloat(imageOfNode(node))
    return volume if orientation is None else _oriented(volume, orientation)


def _oriented(volume: Volume, orientation: str) -> Volume:
    axes = np.zeros((3, 3))
    for axis, letter in enumerate(orientation.upper()[:3]):
        for row, pair in enumerate(("LR", "PA", "IS")):
            if letter in pair:
                axes[row, axis] = 2.0 * pair.index(letter) - 1.0
    if len(orientation) != 3 or not np.linalg.det(axes):
        raise InputError(
            "--orientation must be three letters, one each of R or L, A or P, and S or I: where "
            "the first, second and third axis of the file run to in the patient."
        )
    matrix = np.eye(4)
    matrix[:3, :3] = axes * np.linalg.norm(volume.ijkToRas[:3, :3], axis=0)
    matrix[:3, 3] = -matrix[:3, :3] @ ((np.array(volume.values.shape) - 1) / 2.0)
    return replace(volume, ijkToRas=matrix)


def _checkHeader(path: Path, nifti: vtk.vtkNIFTIImageHeader | None) -> None:
    begin = volume_header.beginOf(path)
    if path.suffix.lower() in (".mgz", ".mgh") or (nifti is None and begin.startswith(_MGH)):
        raise _unusable(path, "is in FreeSurfer's format", "mri_convert makes NIfTI of it")
    if nifti is not None and nifti.GetMagic()[1:3] in ("+2", "i2"):
        raise _unusable(path, "is NIfTI-2", "save it as NIfTI-1 or NRRD")
    if nifti is None and begin.startswith(b"NRRD"):
        fields = volume_header.nrrdFields(begin)
        sizes = [int(size) for size in fields.get("sizes", "").split() if size.isdecimal()]
        kinds = fields.get("kinds", "").lower()
        if len(sizes) == 4 and any(kind in kinds for kind in ("color", "vector", "complex")):
            several = f"has {fields['sizes']} values, several in a voxel"
            raise _unusable(path, several, "use one with gray values")
        _checkSizes(path, tuple(sizes))
    if nifti is not None:
        _checkNifti(path, nifti)


def _checkNifti(path: Path, nifti: vtk.vtkNIFTIImageHeader) -> None:
    _checkSizes(path, _sizesOf(nifti))
    if nifti.GetDataType() in _COLORS:
        raise _unusable(path, "has colors (RGB)", "use the image with one gray value a voxel")
    if nifti.GetDataType() in _COMPLEX:
        raise _unusable(path, "has complex numbers", "use the magnitude")
    if volume_header.isAnalyze(nifti):
        return
    repair = "write the orientation again from the original DICOM files"
    qformCode, sformCode = nifti.GetQFormCode(), nifti.GetSFormCode()
    rotation = nifti.GetQuaternB(), nifti.GetQuaternC(), nifti.GetQuaternD()
    isLong = not np.linalg.norm(rotation) <= _LONGEST_ROTATION
    if qformCode > 0 and (isLong or not all(nifti.GetPixDim(axis) > 0 for axis in (1, 2, 3))):
        raise _unusable(path, "has a qform that is no rotation", repair)
    if sformCode <= 0:
        return
    sform = np.array([nifti.GetSRowX(), nifti.GetSRowY(), nifti.GetSRowZ()])[:, :3]
    lengths = np.linalg.norm(sform, axis=0)
    if not np.isfinite(lengths).all() or not lengths.all():
        raise _unusable(path, "has an sform whose axes have no length", repair)
    axes = sform / lengths
    isSheared = np.abs(axes.T @ axes - np.eye(3)).max() > _RIGHT_ANGLE
    if qformCode <= 0 and isSheared:
        what = "has a sheared sform: its axes are not at right angles"
        raise _unusable(path, what, "resample it")
    if qformCode <= 0:
        return
    scalar = math.sqrt(max(0.0, 1.0 - np.dot(rotation, rotation)))
    flip = -1.0 if nifti.GetPixDim(0) < 0 else 1.0
    qform = Rotation.from_quat([*rotation, scalar]).as_matrix() @ np.diag([1.0, 1.0, flip])
    if np.sum(axes * qform, axis=0).min() < _CONTRADICTION:
        both = f"{_letters(qform)} and {_letters(axes)}"
        what = f"has a qform and an sform that contradict each other ({both})"
        raise _unusable(path, what, "remove the wrong one")


def _letters(axes: np.ndarray) -> str:
    """Return the directions, such as LPS, in which a volume's axes (3, 3) mostly run."""
    main = np.abs(axes).argmax(axis=0)
    return "".join(("RAS" if axes[row, i] > 0 else "LPI")[row] for i, row in enumerate(main))


def _isCutShort(path: Path, nifti: vtk.vtkNIFTIImageHeader | None) -> bool:
    """Return whether a `.gz` file, or a NIfTI-1 file of any kind, ends too early."""
    least = 0.0
    isAlone = path.suffix not in (".hdr", ".img")
    if nifti is not None and isAlone and not volume_header.isAnalyze(nifti):
        least = nifti.GetVoxOffset() + math.prod(_sizesOf(nifti)) * nifti.GetBitPix() / 8
    opened = gzip.open if path.suffix == ".gz" else open
    try:
        with opened(path, "rb") as file:
            return file.seek(0, os.SEEK_END) < least
    except (EOFError, zlib.error):
        return True
    except OSError:
        return False


def _sizesOf(nifti: vtk.vtkNIFTIImageHeader) -> tuple[int, ...]:
    return tuple(nifti.GetDim(axis + 1) for axis in range(min(nifti.GetDim(0), 7)))


def _checkSizes(path: Path, sizes: tuple[int, ...]) -> None:
    if math.prod(sizes[3:]) > 1:
        what = f"has {len(sizes)} dimensions ({' × '.join(map(str, sizes))})"
        raise _unusable(path, what, "extract one 3D image of it")


def _unusable(path: Path, what: str, remedy: str) -> InputError:
    return InputError(f"{path} {what}; {remedy}.")
