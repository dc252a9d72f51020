"""Read a volume from a file such as NRRD or NIfTI, or from DICOM files."""

from __future__ import annotations

import gzip
import os
import zlib
from dataclasses import replace
from pathlib import Path

import numpy as np
import slicer

from rastrainer.errors import InputError
from rastrainer.slicer.head.volume import Volume, asFloat, imageOfNode
from rastrainer.slicer.head.volume_header import checkHeader, leastSize, missingOrientation
from rastrainer_headless.dicom_series import isDicom, readDicom


def readVolume(path: Path, orientation: str | None = None) -> Volume:
    """Read a file that Slicer's volume reader knows, such as NRRD, or a DICOM file or folder.

    `orientation`, such as LAS, is for a file that states none.
    """
    if path.is_dir() or (path.is_file() and isDicom(path)):
        return readDicom(path)
    if not path.is_file():
        raise InputError(f"{path} does not exist; give a volume such as a .nii.gz or .nrrd file.")
    checkHeader(path)
    # A `.nii` or `.nii.gz` file may end too early.
    opened = gzip.open if path.suffix == ".gz" else open
    try:
        with opened(path, "rb") as file:
            isCut = file.seek(0, os.SEEK_END) < leastSize(path)
    except (EOFError, zlib.error):
        isCut = True
    except OSError:
        isCut = False
    if isCut:
        raise InputError(f"{path} is cut short; copy the file again.")
    missing = missingOrientation(path)
    if missing and orientation is None:
        raise InputError(
            f"{path} does not state the patient's orientation ({missing}): left and right, front "
            "and back are unknown. Where you know how its axes run, say so: --orientation LAS is "
            "left, anterior, superior."
        )
    scene = slicer.vtkMRMLScene()
    node = scene.AddNewNodeByClass("vtkMRMLScalarVolumeNode")
    storage = slicer.vtkMRMLVolumeArchetypeStorageNode()
    storage.SetFileName(str(path))
    if not storage.ReadData(node) or node.GetImageData() is None:
        raise InputError(f"{path} could not be read as a volume such as NIfTI or NRRD.")
    volume = asFloat(imageOfNode(node))
    return volume if orientation is None else _oriented(volume, orientation)


def _oriented(volume: Volume, orientation: str) -> Volume:
    """Return a volume around the origin whose axes run in the stated directions."""
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
