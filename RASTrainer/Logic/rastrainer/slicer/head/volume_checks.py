"""Is it a volume of a head at all? One sentence where it is not, or where it is a poor one."""

from __future__ import annotations

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.slicer.head.volume import Volume

FEWEST_VOXELS = 16
MOST_VOXELS = 600_000_000
SMALLEST_MM, LARGEST_MM = 90.0, 1000.0
THICKEST_SLICES_MM = 6.0
COARSE_MM = 2.5
HEAD_EXTENT_MM = ((90.0, 260.0), (110.0, 320.0), (80.0, 320.0))
"""Right-left, posterior-anterior and inferior-superior: from small children to adults with ears."""

FULLEST = 0.85
"""A head fills about half of its bounding box; what fills more of it is no head."""


def check_volume(volume: Volume) -> list[str]:
    """Return warnings for a volume that can be used, one sentence each.

    Raises:
        InputError: it cannot be used.
    """
    values, shape = volume.values, volume.values.shape
    if values.ndim != 3 or min(shape) < FEWEST_VOXELS:
        raise InputError(
            f"The volume has {' × '.join(map(str, shape))} voxels; a head needs a 3D volume of at "
            f"least {FEWEST_VOXELS} in each direction."
        )
    if values.size > MOST_VOXELS:
        raise InputError(f"The volume has {values.size / 1e6:.0f} million voxels; crop it.")
    if not np.isfinite(values).all():
        raise InputError("The volume holds values that are no numbers (NaN or infinite).")
    if values.min() == values.max():
        raise InputError("The volume is empty: all its voxels have the same value.")
    return _check_spacing(volume)


def _check_spacing(volume: Volume) -> list[str]:
    axes = volume.ijk_to_ras[:3, :3]
    spacing = np.linalg.norm(axes, axis=0)
    if not np.isfinite(volume.ijk_to_ras).all() or spacing.min() <= 0:
        raise InputError("The volume does not tell where it lies in the patient.")
    if abs(np.linalg.det(axes / spacing)) < 0.1:
        raise InputError("The volume's axes do not span a space: its orientation is damaged.")
    extent = spacing * volume.values.shape
    if extent.max() < SMALLEST_MM or extent.max() > LARGEST_MM:
        raise InputError(
            f"The volume measures {' × '.join(f'{e:.3g}' for e in extent)} mm: no head is that "
            "size. Its spacing is probably not in millimeters."
        )
    if spacing.max() > THICKEST_SLICES_MM:
        raise InputError(
            f"The volume's slices are {spacing.max():.1f} mm apart; a head's surface needs at most "
            f"{THICKEST_SLICES_MM:g} mm."
        )
    if spacing.max() > COARSE_MM:
        return [
            f"The slices are {spacing.max():.1f} mm apart: between them the skin is guessed, and "
            "may be off by a millimeter or two at the nose, the ears and the crown."
        ]
    return []


def check_head(mesh: HeadMesh) -> None:
    """Raise a sentence where a closed surface cannot be a head's.

    Raises:
        InputError: its size or shape is no head's.
    """
    extent = np.ptp(mesh.vertices, axis=0)
    a, b, c = (mesh.vertices[mesh.triangles[:, corner]].astype(float) for corner in range(3))
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
    is_size = all(low <= e <= high for e, (low, high) in zip(extent, HEAD_EXTENT_MM, strict=True))
    if not is_size or volume > FULLEST * extent.prod():
        raise InputError(
            f"No head was found: what is above the threshold measures {extent[0]:.0f} × "
            f"{extent[1]:.0f} × {extent[2]:.0f} mm and looks like no head. Try another threshold "
            "or cut."
        )
