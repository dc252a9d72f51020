"""Finds the head in a volume, for the simulator.

An image becomes a level set of the head's tissue, continued past the edges of the image; that, a
body without cavities and tunnels; and that, a closed surface.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.slicer.head import mask, surface
from rastrainer.slicer.head.intensities import CT_AIR, isHounsfield
from rastrainer.slicer.head.volume import SPACING_MM, HeadBody, HeadSettings, Volume, onRasGrid
from rastrainer.work_progress import Progress

CT_SKIN = -475.0
"""Hounsfield units; the skin's surface is half-way between air and tissue."""

AIR_QUANTILE = 0.01
TAIL_QUANTILE, TAIL_FACTOR = 0.999, 1.5
"""Values above that multiple of the quantile are few and bright (vessels, metal). They are clipped;
otherwise they alone would count as tissue."""


@dataclass(frozen=True)
class Tissue:
    """The tissue in an image.

    `level` (i, j, k) is within ±1, positive in tissue, its zero between the voxels.
    """

    level: np.ndarray
    threshold: float
    isCt: bool


def findTissue(values: np.ndarray, threshold: float | None, noise: float) -> Tissue:
    """Return the head's tissue, alone.

    Without a threshold it is −475 HU of a CT, else found by Otsu's method. `noise` is the standard
    deviation of the smoothing, in voxels.
    """
    isCt = isHounsfield(values)
    # Normalized values of an MRI begin below 0.
    air = CT_AIR if isCt else min(0.0, float(np.quantile(values[::2, ::2, ::2], AIR_QUANTILE)))
    smooth = ndimage.gaussian_filter(np.maximum(values, air) - air, noise, mode="nearest")
    if threshold is None:
        high = TAIL_FACTOR * float(np.quantile(smooth[::2, ::2, ::2], TAIL_QUANTILE))
        bounded = np.minimum(smooth, high) if high > 0 else smooth
        found = CT_SKIN - CT_AIR if isCt else mask.otsuThreshold(bounded)
    else:
        found = threshold - air
    if threshold is None and found <= 0:
        raise InputError("No head was found: the image has no tissue that is brighter than air.")
    if found <= 0:
        raise InputError(f"The threshold must be above that of air, {air:g}: the skin is brighter.")
    level = np.clip(smooth / found - 1.0, -1.0, 1.0)
    # Filled first: the skull's dark layer may part the scalp from a brain that is larger.
    head = mask.largestBody(mask.withoutCavities(level > 0))
    level = np.where(head | (level <= 0), level, -1.0).astype(np.float32)
    return Tissue(level, found + air, isCt)


TREND_LENGTH = 5
"""Over how many voxels the trend of an outline is measured."""

FASTEST_TREND = 2.0
"""Most voxels by which an outline shrinks per voxel at the image's edge; it never grows."""

ROUNDING = 1 / 6
"""Voxels per square voxel by which it shrinks ever faster, so that a cut head ends rounded."""


def continued(level: np.ndarray, margin: int) -> np.ndarray:
    """Pad a level set (positive inside) by `margin` voxels on every side.

    The first two axes are continued on both sides, the third upward, all by the outline's own
    trend; downward the lowest slice is repeated. Beyond the image the level is a distance in
    voxels, within ±1.
    """
    padded = np.pad(level, [(0, 0), (0, 0), (margin, 0)], mode="edge")
    for axis in (0, 1):
        padded = _continueEnd(padded, axis, margin)
        padded = np.flip(_continueEnd(np.flip(padded, axis), axis, margin), axis)
    return _continueEnd(padded, 2, margin)


def _continueEnd(level: np.ndarray, axis: int, margin: int) -> np.ndarray:
    slices = np.moveaxis(level, axis, 0)
    outline, earlier = _signedDistance(slices[-1]), _signedDistance(slices[-1 - TREND_LENGTH])
    beyond = np.full((margin, *slices.shape[1:]), -1.0, level.dtype)
    if outline is not None:
        trend = np.zeros_like(outline) if earlier is None else (outline - earlier) / TREND_LENGTH
        trend = np.clip(ndimage.gaussian_filter(trend, 2.0), -FASTEST_TREND, 0.0)
        steps = np.arange(1, margin + 1)[:, None, None]
        beyond[:] = np.clip(outline + steps * trend - ROUNDING * steps**2, -1.0, 1.0)
    return np.concatenate([level, np.moveaxis(beyond, 0, axis)], axis=axis)


def _signedDistance(sliceLevel: np.ndarray) -> np.ndarray | None:
    """Return the distance to a slice's outline, positive inside; None for an empty slice."""
    inside = sliceLevel > 0
    if not inside.any():
        return None
    margin = 12
    # Repeated edges: where the head continues beyond this slice's own edge, there is no outline.
    padded = np.pad(inside, margin, mode="edge")
    distance = ndimage.distance_transform_edt(padded) - ndimage.distance_transform_edt(~padded)
    crop = (slice(margin, -margin),) * 2
    return ndimage.gaussian_filter(distance, 1.0)[crop]


MARGIN = 14
"""Voxels added around the image, in which the nose and the ears may close."""

CAVITY_DEPTH_MM = 4.0
"""Cavities so deep below the skin are filled: airways, sinuses, ear canals."""

TRIANGLES, MAX_TRIANGLES = 55_000, 60_000
"""How many are aimed at, to which the flat base adds a few; and most."""
MAX_DECIMATIONS, BASE_RESERVE = 3, 500
LONGEST_HEAD_MM = 200.0
"""Measured down from the crown: neck and shoulders below are cut off."""


def findHead(volume: Volume, settings: HeadSettings, progress: Progress) -> HeadBody:
    """Return the head of a T1-weighted MRI or CT."""
    progress("Reading the volume", 0.0)
    grid = onRasGrid(volume, SPACING_MM)
    progress("Finding the skin", 0.1)
    found = findTissue(grid.values, settings.threshold, settings.noiseMm / SPACING_MM)
    lowest = grid.ijkToRas[2, 3]
    top = lowest + SPACING_MM * np.flatnonzero((found.level > 0).any(axis=(0, 1))).max()
    base = settings.baseMm
    if base is None:
        base = max(lowest + SPACING_MM, top - LONGEST_HEAD_MM)
    if not lowest <= base < top:
        raise InputError(
            f"The head is found between {lowest:.0f} and {top:.0f} mm (S); its base must be in "
            f"this range, not at {base:.0f} mm."
        )
    below = max(0, int((base - lowest) / SPACING_MM) - 1)
    # The part of the image that the head needs; more would cost time.
    spans = []
    for axis, count in enumerate(found.level.shape):
        others = tuple(other for other in range(3) if other != axis)
        inside = np.flatnonzero((found.level > 0).any(axis=others))
        spans.append((max(0, inside[0] - MARGIN), min(count, inside[-1] + 1 + MARGIN)))
    around = slice(*spans[0]), slice(*spans[1]), slice(below, spans[2][1])
    level = continued(found.level[around], MARGIN)
    progress("Filling cavities", 0.3)
    body = _body(level > 0, settings.openingMm, progress)
    first = np.array([part.start for part in around])
    origin = grid.ijkToRas[:3, 3] + (first - MARGIN) * SPACING_MM
    return HeadBody(level, body, origin, base, found.threshold, found.isCt)


def skinOf(head: HeadBody, progress: Progress) -> HeadMesh:
    """Return the skin as one closed surface of genus 0 with a flat base."""
    progress("Making the surface", 0.8)
    # Changed only in voxels that disagree with the body.
    level = np.where(head.body, np.maximum(head.level, 0.05), np.minimum(head.level, -0.05))
    skin = surface.surfaceOf(level, head.origin, SPACING_MM)
    skin, wanted = surface.smoothed(skin), TRIANGLES
    for _ in range(MAX_DECIMATIONS):
        mesh = surface.meshOf(surface.decimated(skin, wanted, head.baseMm))
        if mesh.is_closed:
            mesh = surface.cutFlat(mesh, head.baseMm)
        # The base is not decimated with the rest; how many it adds shows only afterward.
        over = len(mesh.triangles) - MAX_TRIANGLES
        isSound = mesh.is_closed and mesh.euler_characteristic == 2
        if over <= 0 and isSound:
            progress("Done", 1.0)
            return mesh
        # Another number of triangles also avoids what decimation has torn.
        wanted -= max(0, over) + BASE_RESERVE
    if not isSound:
        raise InputError(
            "No head was found: its surface could not be closed; try another threshold or base."
        )
    raise InputError(
        f"The head's surface has {len(mesh.triangles)} triangles, more than {MAX_TRIANGLES}; "
        "aim at fewer."
    )


def _body(inside: np.ndarray, openingMm: float, progress: Progress) -> np.ndarray:
    """Return the head without cavities and tunnels, as little filled as possible."""
    hull = mask.withoutCavities(mask.closedByBall(inside, openingMm / 2))
    progress("Filling cavities", 0.45)
    depth = CAVITY_DEPTH_MM / SPACING_MM
    deep = mask.depthInside(hull, depth) > depth
    wanted = mask.withoutCavities(inside | deep)
    progress("Closing tunnels", 0.55)
    for radius in openingMm * np.array([0.5, 1.0, 2.0, 4.0]):
        body = mask.withoutCavities(mask.closedByBall(wanted, radius / SPACING_MM))
        contour = surface.meshOf(surface.surfaceOf(np.where(body, 1.0, -1.0), np.zeros(3), 1.0))
        if contour.euler_characteristic == 2:
            progress("Closing tunnels", 0.7)
            return mask.carved(body, wanted)
    raise InputError("No head was found: the shape above the threshold has too many tunnels.")
