"""The skull: bone of a CT; of MRI, where bone is as dark as air, only an approximation."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from rastrainer.errors import InputError
from rastrainer.head_mesh import HeadMesh
from rastrainer.slicer.head import mask, surface
from rastrainer.slicer.head.head_body import SPACING_MM, HeadBody
from rastrainer.slicer.head.volume import Volume, on_ras_grid

CT_BONE = 300.0
"""Hounsfield units; cortical bone has more, contrast in vessels may too."""

CT_NOISE_MM = 0.7
SCALP_MM = 7.0
"""From the skin to the skull where MRI cannot tell: a usual thickness, not the patient's."""

TRIANGLES = 30_000


def skull_of(volume: Volume, head: HeadBody) -> HeadMesh:
    """Return the skull above the head's base: bone of a CT, else the skin moved inward.

    Raises:
        InputError: there is none.
    """
    level = _bone(volume, head) if head.is_ct else _below_scalp(head)
    heights = head.origin[2] + SPACING_MM * np.arange(level.shape[2])
    level = np.where(heights >= head.base_mm, level, -1.0).astype(np.float32)
    body = mask.largest_body(level > 0)
    level = np.where(body | (level <= 0), level, -1.0)
    skull = surface.smoothed(surface.surface_of(level, head.origin, SPACING_MM))
    return surface.mesh_of(surface.decimated(skull, TRIANGLES, head.base_mm))


def _bone(volume: Volume, head: HeadBody) -> np.ndarray:
    """Return the level set of bone on the head's grid."""
    grid = on_ras_grid(volume, SPACING_MM)
    smooth = ndimage.gaussian_filter(grid.values, CT_NOISE_MM / SPACING_MM, mode="nearest")
    bone = np.full(head.level.shape, -1.0, np.float32)
    first = np.rint((grid.ijk_to_ras[:3, 3] - head.origin) / SPACING_MM).astype(int)
    # The head's grid has a margin, and begins where its base is.
    into = tuple(slice(max(0, f), max(0, f + n)) for f, n in zip(first, smooth.shape, strict=True))
    room = bone[into].shape
    start = np.maximum(0, -first)
    taken = smooth[tuple(slice(s, s + n) for s, n in zip(start, room, strict=True))]
    bone[into] = np.clip(taken / CT_BONE - 1.0, -1.0, 1.0)
    if not (bone > 0).any():
        raise InputError("The CT shows no bone.")
    return np.where(head.body, bone, -1.0)


def _below_scalp(head: HeadBody) -> np.ndarray:
    scalp = SCALP_MM / SPACING_MM
    return np.clip(mask.depth_inside(head.body, scalp + 1.0) - scalp, -1.0, 1.0)
