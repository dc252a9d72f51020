"""What a draft holds besides the skin: the images of the head, and its skull."""

from __future__ import annotations

import numpy as np
from scipy import ndimage

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.volume import KEPT_MM, HeadVolume
from rastrainer.slicer.head import mask, surface
from rastrainer.slicer.head.head_body import SPACING_MM, HeadBody
from rastrainer.slicer.head.level_set import CT_AIR
from rastrainer.slicer.head.volume import Volume, onRasGrid, sampled

HOUNSFIELD = (-1024.0, 3071.0)
CT_WINDOW, CT_LEVEL = 400.0, 40.0
"""Soft tissue, with bone white and air black."""

BRIGHTEST_QUANTILE, WHITE_QUANTILE = 0.9995, 0.995
"""Of the MRI's values in the head: what 255 stands for, and what is shown white."""

_MAX_GRAY = 255.0


def imageOf(volume: Volume, head: HeadBody) -> tuple[HeadVolume, str]:
    """Return a head's images on a grid of 1 mm along RAS, and a sentence on how they were made.

    MRI becomes uint8: from the darkest value of the volume to the brightest of the head, unless
    its values are such numbers already. CT becomes int16, Hounsfield units.

    Args:
        volume: what the head was found in.
        head: as `findHead` has found it.
    """
    near = mask.squaredDistances(head.body, KEPT_MM / SPACING_MM) <= (KEPT_MM / SPACING_MM) ** 2
    near[:, :, : max(0, int(np.floor((head.baseMm - head.origin[2]) / SPACING_MM)))] = False
    around = ndimage.find_objects(near.astype(np.uint8))[0]
    near, body = near[around], head.body[around]
    gridToRas = np.diag([SPACING_MM] * 3 + [1.0])
    gridToRas[:3, 3] = head.origin + SPACING_MM * np.array([part.start for part in around])
    values = np.where(near, sampled(volume, gridToRas, near.shape), volume.values.min())
    if head.isCt:
        units = np.rint(np.clip(np.where(near, values, CT_AIR), *HOUNSFIELD)).astype(np.int16)
        low, high = HOUNSFIELD
        method = f"Images: CT, 1 mm, Hounsfield units from {low:g} to {high:g}."
        return HeadVolume(units, gridToRas, CT_WINDOW, CT_LEVEL), method
    grays, method = _grays(values, volume.values, body)
    white = max(2.0, float(np.quantile(grays[body], WHITE_QUANTILE)))
    return HeadVolume(grays, gridToRas, white, white / 2.0), method


def _grays(values: np.ndarray, source: np.ndarray, body: np.ndarray) -> tuple[np.ndarray, str]:
    """Return an MRI's values as uint8, and a sentence on what they mean."""
    low, high = float(source.min()), float(np.quantile(values[body], BRIGHTEST_QUANTILE))
    if low >= 0 and source.max() <= _MAX_GRAY and np.array_equal(source, np.rint(source)):
        return np.rint(values).astype(np.uint8), "Images: MRI, 1 mm, its own values, 0 to 255."
    scaled = np.clip((values - low) * (_MAX_GRAY / max(high - low, 1e-30)), 0.0, _MAX_GRAY)
    method = f"Images: MRI, 1 mm, values from {low:.6g} to {high:.6g} as 0 to 255."
    return np.rint(scaled).astype(np.uint8), method


CT_BONE = 300.0
"""Hounsfield units; cortical bone has more, contrast in vessels may too."""

CT_NOISE_MM = 0.7
SCALP_MM = 7.0
"""From the skin to the skull, which MRI does not show: a usual thickness, not the patient's."""
BONE_MM = 7.0
"""From the outer to the inner table, where MRI shows neither: the mean of the parietal bone; the
frontal has 8.0 and the temporal 4.7 mm (Thulung et al. 2019, 10.31729/jnma.3949)."""

TRIANGLES = 30_000


def skullOf(volume: Volume, head: HeadBody) -> HeadMesh:
    """Return the skull above the head's base: bone of a CT, else a shell parallel to the skin.

    Raises:
        InputError: there is none.
    """
    level = _bone(volume, head) if head.isCt else _belowScalp(head)
    heights = head.origin[2] + SPACING_MM * np.arange(level.shape[2])
    level = np.where(heights >= head.baseMm, level, -1.0).astype(np.float32)
    body = mask.largestBody(level > 0)
    level = np.where(body | (level <= 0), level, -1.0)
    skull = surface.smoothed(surface.surfaceOf(level, head.origin, SPACING_MM))
    return surface.meshOf(surface.decimated(skull, TRIANGLES, head.baseMm))


def _bone(volume: Volume, head: HeadBody) -> np.ndarray:
    """Return the level set of bone on the head's grid."""
    grid = onRasGrid(volume, SPACING_MM)
    smooth = ndimage.gaussian_filter(grid.values, CT_NOISE_MM / SPACING_MM, mode="nearest")
    bone = np.full(head.level.shape, -1.0, np.float32)
    first = np.rint((grid.ijkToRas[:3, 3] - head.origin) / SPACING_MM).astype(int)
    # The head's grid has a margin, and begins where its base is.
    into = tuple(slice(max(0, f), max(0, f + n)) for f, n in zip(first, smooth.shape, strict=True))
    room = bone[into].shape
    start = np.maximum(0, -first)
    taken = smooth[tuple(slice(s, s + n) for s, n in zip(start, room, strict=True))]
    bone[into] = np.clip(taken / CT_BONE - 1.0, -1.0, 1.0)
    if not (bone > 0).any():
        raise InputError("The CT shows no bone.")
    return np.where(head.body, bone, -1.0)


def _belowScalp(head: HeadBody) -> np.ndarray:
    """Return the level set of a shell between two depths below the skin."""
    outer, inner = SCALP_MM / SPACING_MM, (SCALP_MM + BONE_MM) / SPACING_MM
    depth = mask.depthInside(head.body, inner + 1.0)
    level = np.clip(depth - outer, -1.0, 1.0)
    # The cavity of the brain alone: noses and ears are solid.
    cavity = ndimage.binary_dilation(mask.largestBody(depth > inner), iterations=2)
    return np.where(cavity, np.minimum(level, np.clip(inner - depth, -1.0, 1.0)), level)
