"""The images of a scenario's head, in an NRRD file, RAS mm."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.json_fields import Fields
from rastrainer.files.nrrd import read_nrrd, write_nrrd
from rastrainer.head.mesh import HeadMesh

MAX_GRAY_LEVEL = 32768.0
"""Of window and level: as far as the values of a volume go."""

KEPT_MM = 6.0
"""Around the head; what lies farther away may be noise, a frame, a text or a wrapped nose."""

MIN_COVERED_SHARE = 0.5
"""Share of the head's vertices that lie in the images: scans often lack the nose and the ears."""


@dataclass(frozen=True)
class VolumeFile:
    """A scenario's volume, not read yet.

    Attributes:
        path: of the NRRD file.
        window, level: values displayed from black to white.
    """

    path: Path
    window: float
    level: float


@dataclass(frozen=True)
class HeadVolume:
    """A scalar image of a head.

    Attributes:
        values: (i, j, k) uint8 or int16.
        ijk_to_ras: (4, 4) float, voxel index to RAS mm.
        window, level: as of `VolumeFile`.
    """

    values: np.ndarray
    ijk_to_ras: np.ndarray
    window: float
    level: float


def read_volume_file(fields: Fields) -> VolumeFile | None:
    """Return the field `volume`, or None."""
    if "volume" not in fields.names():
        return None
    volume = fields.fields("volume")
    window = volume.number("window", 1, 2 * MAX_GRAY_LEVEL)
    return VolumeFile(
        volume.file("file"), window, volume.number("level", -MAX_GRAY_LEVEL, MAX_GRAY_LEVEL)
    )


def read_head_volume(file: VolumeFile) -> HeadVolume:
    """Read the volume of a scenario.

    Raises:
        InputError: it is missing or unusable.
    """
    return HeadVolume(*read_nrrd(file.path), file.window, file.level)


def write_head_volume(path: Path, volume: HeadVolume) -> None:
    """Write the voxels and geometry of a volume, and nothing else.

    Raises:
        InputError: the file cannot be written.
    """
    write_nrrd(path, volume.values, volume.ijk_to_ras)


def check_place(volume: HeadVolume, head: HeadMesh, path: Path) -> None:
    """Check that a volume covers its head.

    Raises:
        InputError: less than half of the head is in the volume.
    """
    indices = transforms.apply(transforms.inverse(volume.ijk_to_ras), head.vertices.astype(float))
    is_within = (indices >= -0.5) & (indices <= np.array(volume.values.shape) - 0.5)
    if is_within.all(axis=1).mean() < MIN_COVERED_SHARE:
        raise InputError(f"The volume {path} must lie where the head is.")
