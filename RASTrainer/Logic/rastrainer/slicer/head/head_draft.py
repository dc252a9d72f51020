"""Makes the draft of a head out of a volume: checks, extraction, images and skull, in one call."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from scipy import ndimage

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.volume import KEPT_MM, HeadVolume
from rastrainer.scenario.scenario import SkullKind
from rastrainer.scenario.writer import HeadDraft
from rastrainer.slicer.head import intensities, mask, surface
from rastrainer.slicer.head.extraction import findHead, skinOf
from rastrainer.slicer.head.volume import (
    SPACING_MM,
    HeadBody,
    HeadSettings,
    SegmentImage,
    Volume,
    asFloat,
    forSegment,
    onRasGrid,
    sampled,
    volumeOfSegment,
)
from rastrainer.work_progress import Progress, no_progress


def makeDraft(
    volume: Volume,
    settings: HeadSettings | None = None,
    hasSkull: bool = True,
    progress: Progress = no_progress,
    segment: SegmentImage | None = None,
    headMade: Callable[[HeadDraft, list[str]], None] = lambda _draft, _warnings: None,
    hasVolume: bool = True,
) -> tuple[HeadDraft, list[str]]:
    """Return a head and warnings, one sentence each, from a T1-weighted MRI or CT of a head.

    Without a `segment`, the head is found in the volume. `headMade` is given the draft without its
    skull and the warnings, before the skull is made.
    """
    volume, found, mesh, warnings = _findSkin(
        volume, settings, lambda step, share: progress(step, 0.8 * share), segment
    )
    kind = "CT" if found.isCt else "MRI"
    how = f"threshold {found.threshold:.5g}" if segment is None else "segment edited by hand"
    method = (
        f"Surface of the skin from {kind} by rastrainer, {how}, cavities filled, cut flat at "
        f"{found.baseMm:.1f} mm (S)."
    )
    draft = HeadDraft(mesh, method)
    if hasVolume:
        progress("Preparing the images", 0.8)
        images, how = imageOf(volume, found)
        draft = replace(draft, method=f"{draft.method} {how}", volume=images)
    headMade(draft, warnings)
    if hasSkull:
        progress("Making the skull", 0.85)
        shell = f"a shell from {SCALP_MM:g} to {SCALP_MM + BONE_MM:g} mm below the skin"
        how = f"Skull: an approximation, {shell}; MRI shows no bone."
        bone = SkullKind.APPROXIMATION
        if found.isCt:
            how, bone = "Skull: bone of the CT.", SkullKind.BONE
        skull, method = skullOf(volume, found), f"{draft.method} {how}"
        draft = replace(draft, method=method, skull=skull, skull_kind=bone)
    progress("Done", 1.0)
    return draft, warnings


def findSkin(
    volume: Volume, settings: HeadSettings | None = None, progress: Progress = no_progress
) -> tuple[HeadBody, HeadMesh, list[str]]:
    """Return a head as voxels and as a surface, and warnings; otherwise as `makeDraft`."""
    return _findSkin(volume, settings, progress, None)[1:]


def _findSkin(
    volume: Volume, settings: HeadSettings | None, progress: Progress, segment: SegmentImage | None
) -> tuple[Volume, HeadBody, HeadMesh, list[str]]:
    """Return a copy of the volume with measured values alone, and what `findSkin` does."""
    volume, settings = asFloat(volume), settings or HeadSettings()
    warnings = [*volume.warnings, *checkVolume(volume)]
    volume, offset, more = intensities.cleaned(volume)
    if segment is not None:
        found = findHead(volumeOfSegment(segment), forSegment(settings), progress)
        found = replace(found, isCt=intensities.isHounsfield(volume.values))
    else:
        if settings.threshold is not None:
            settings = replace(settings, threshold=settings.threshold + offset)
        found = findHead(volume, settings, progress)
    mesh = skinOf(found, progress)
    checkHead(mesh)
    return volume, found, mesh, warnings + more + intensities.skullWarnings(volume, found)


FEWEST_VOXELS = 16
MAX_VOXELS = 600_000_000
SMALLEST_MM, LARGEST_MM = 90.0, 1000.0
THICKEST_SLICES_MM = 6.0
COARSE_MM = 2.5
HEAD_EXTENT_MM = ((90.0, 260.0), (110.0, 320.0), (80.0, 320.0))
"""Right-left, posterior-anterior and inferior-superior: from small children to adults with ears."""

FULLEST = 0.85
"""A head fills about half of its bounding box; what fills more of it is no head."""


def checkVolume(volume: Volume) -> list[str]:
    """Return warnings for a volume that can be used, one sentence each."""
    values, shape = volume.values, volume.values.shape
    if values.ndim != 3 or min(shape) < FEWEST_VOXELS:
        raise InputError(
            f"The volume has {' × '.join(map(str, shape))} voxels; a head needs a 3D volume of at "
            f"least {FEWEST_VOXELS} in each direction."
        )
    if values.size > MAX_VOXELS:
        raise InputError(f"The volume has {values.size / 1e6:.0f} million voxels; crop it.")
    if not np.isfinite(values).all():
        raise InputError("The volume contains values that are not numbers (NaN or infinite).")
    if values.min() == values.max():
        raise InputError("The volume is empty: all its voxels have the same value.")
    axes = volume.ijkToRas[:3, :3]
    spacing = np.linalg.norm(axes, axis=0)
    if not np.isfinite(volume.ijkToRas).all() or spacing.min() <= 0:
        raise InputError("The volume does not say where it lies in the patient.")
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
            f"The slices are {spacing.max():.1f} mm apart: between them the skin is interpolated, "
            "and may be off by a millimeter or two at the nose, the ears and the crown."
        ]
    return []


def checkHead(mesh: HeadMesh) -> None:
    extent = np.ptp(mesh.vertices, axis=0)
    a, b, c = (corner.astype(float) for corner in mesh.corners())
    volume = np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6.0
    isSize = all(low <= e <= high for e, (low, high) in zip(extent, HEAD_EXTENT_MM, strict=True))
    if not isSize or volume > FULLEST * extent.prod():
        raise InputError(
            f"No head was found: what is above the threshold measures {extent[0]:.0f} × "
            f"{extent[1]:.0f} × {extent[2]:.0f} mm and does not look like a head. Try another "
            "threshold or cut."
        )


HOUNSFIELD = (-1024.0, 3071.0)
CT_WINDOW, CT_LEVEL = 400.0, 40.0
"""Soft tissue, with bone white and air black."""

BRIGHTEST_QUANTILE, WHITE_QUANTILE = 0.9995, 0.995
"""Quantiles of the MRI's values in the head: the value stored as 255, and the value shown white."""

_MAX_GRAY = 255.0


def imageOf(volume: Volume, head: HeadBody) -> tuple[HeadVolume, str]:
    """Return a head's images on a grid of 1 mm along RAS, and a sentence on how they were made.

    MRI becomes uint8: from the darkest value of the volume to the brightest of the head, unless its
    values are such numbers already. CT becomes int16, Hounsfield units.
    """
    near = mask.squaredDistances(head.body, KEPT_MM / SPACING_MM) <= (KEPT_MM / SPACING_MM) ** 2
    near[:, :, : max(0, int(np.floor((head.baseMm - head.origin[2]) / SPACING_MM)))] = False
    around = ndimage.find_objects(near.astype(np.uint8))[0]
    near, body = near[around], head.body[around]
    gridToRas = np.diag([SPACING_MM] * 3 + [1.0])
    gridToRas[:3, 3] = head.origin + SPACING_MM * np.array([part.start for part in around])
    values = np.where(near, sampled(volume, gridToRas, near.shape), volume.values.min())
    if head.isCt:
        values = np.where(near, values, intensities.CT_AIR)
        units = np.rint(np.clip(values, *HOUNSFIELD)).astype(np.int16)
        low, high = HOUNSFIELD
        method = f"Images: CT, 1 mm, Hounsfield units from {low:g} to {high:g}."
        return HeadVolume(units, gridToRas, CT_WINDOW, CT_LEVEL), method
    source = volume.values
    low, high = float(source.min()), float(np.quantile(values[body], BRIGHTEST_QUANTILE))
    method = f"Images: MRI, 1 mm, values from {low:.6g} to {high:.6g} as 0 to 255."
    if low >= 0 and source.max() <= _MAX_GRAY and np.array_equal(source, np.rint(source)):
        method = "Images: MRI, 1 mm, its own values, 0 to 255."
    else:
        values = np.clip((values - low) * (_MAX_GRAY / max(high - low, 1e-30)), 0.0, _MAX_GRAY)
    grays = np.rint(values).astype(np.uint8)
    white = max(2.0, float(np.quantile(grays[body], WHITE_QUANTILE)))
    return HeadVolume(grays, gridToRas, white, white / 2.0), method


CT_NOISE_MM = 0.7
SCALP_MM = 7.0
"""Thickness of the scalp, which MRI does not show: a usual value, not the patient's."""
BONE_MM = 7.0
"""Thickness of the skull, which MRI does not show: the mean of the parietal bone; the frontal bone
has 8.0 and the temporal 4.7 mm (Thulung et al. 2019, 10.31729/jnma.3949)."""

TRIANGLES = 30_000


def skullOf(volume: Volume, head: HeadBody) -> HeadMesh:
    """Return the skull above the head's base: bone of a CT, else a shell parallel to the skin."""
    level = _bone(volume, head) if head.isCt else _belowScalp(head)
    heights = head.origin[2] + SPACING_MM * np.arange(level.shape[2])
    level = np.where(heights >= head.baseMm, level, -1.0).astype(np.float32)
    body = mask.largestBody(level > 0)
    level = np.where(body | (level <= 0), level, -1.0)
    skull = surface.smoothed(surface.surfaceOf(level, head.origin, SPACING_MM))
    return surface.meshOf(surface.decimated(skull, TRIANGLES, head.baseMm))


def _bone(volume: Volume, head: HeadBody) -> np.ndarray:
    grid = onRasGrid(volume, SPACING_MM)
    smooth = ndimage.gaussian_filter(grid.values, CT_NOISE_MM / SPACING_MM, mode="nearest")
    bone = np.full(head.level.shape, -1.0, np.float32)
    first = np.rint((grid.ijkToRas[:3, 3] - head.origin) / SPACING_MM).astype(int)
    # The head's grid has a margin, and begins where its base is.
    into = tuple(slice(max(0, f), max(0, f + n)) for f, n in zip(first, smooth.shape, strict=True))
    room = bone[into].shape
    start = np.maximum(0, -first)
    taken = smooth[tuple(slice(s, s + n) for s, n in zip(start, room, strict=True))]
    bone[into] = np.clip(taken / intensities.CT_BONE - 1.0, -1.0, 1.0)
    if not (bone > 0).any():
        raise InputError("The CT shows no bone.")
    return np.where(head.body, bone, -1.0)


def _belowScalp(head: HeadBody) -> np.ndarray:
    outer, inner = SCALP_MM / SPACING_MM, (SCALP_MM + BONE_MM) / SPACING_MM
    depth = mask.depthInside(head.body, inner + 1.0)
    level = np.clip(depth - outer, -1.0, 1.0)
    # The cavity of the brain alone: noses and ears are solid.
    cavity = ndimage.binary_dilation(mask.largestBody(depth > inner), iterations=2)
    return np.where(cavity, np.minimum(level, np.clip(inner - depth, -1.0, 1.0)), level)
