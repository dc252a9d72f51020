"""From a volume to a head that the simulator can train on."""

from __future__ import annotations

import numpy as np
import vtk

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.progress import Progress
from rastrainer.slicer.head import level_set, mask, surface
from rastrainer.slicer.head.head_body import SPACING_MM, HeadBody, HeadSettings
from rastrainer.slicer.head.volume import Volume, onRasGrid

MARGIN = 14
"""Voxels added around the image, in which the nose and the ears may close."""

MAX_TRIANGLES = 60_000
MAX_DECIMATIONS, BASE_RESERVE = 3, 500
HAIRS_MM = (0.0, 0.2, 0.4)
LONGEST_HEAD_MM = 200.0
"""From the crown down: what a scan shows below of neck and shoulders is cut off."""


def findHead(volume: Volume, settings: HeadSettings, progress: Progress) -> HeadBody:
    """Return the head of a volume.

    Args:
        volume: T1-weighted MRI or CT of a head.
        settings: what to choose otherwise than usual.
        progress: called with each step's name and the share of the work done; may raise to cancel.

    Raises:
        InputError: there is no head in the volume.
    """
    progress("Reading the volume", 0.0)
    grid = onRasGrid(volume, SPACING_MM)
    progress("Finding the skin", 0.1)
    found = level_set.findTissue(grid.values, settings.threshold, settings.noiseMm / SPACING_MM)
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
    around = _around(found.level > 0, below)
    level = level_set.continued(found.level[around], MARGIN)
    progress("Filling cavities", 0.3)
    body = _body(level > 0, settings, progress)
    first = np.array([part.start for part in around])
    origin = grid.ijkToRas[:3, 3] + (first - MARGIN) * SPACING_MM
    return HeadBody(level, body, origin, base, found.threshold, found.isCt)


def skinOf(head: HeadBody, settings: HeadSettings, progress: Progress) -> HeadMesh:
    """Return the skin as one closed surface of genus 0 with a flat base.

    Raises:
        InputError: no closed surface could be made of it.
    """
    progress("Making the surface", 0.8)
    skin = surface.surfaceOf(_agreeing(head.level, head.body), head.origin, SPACING_MM)
    skin, wanted = surface.smoothed(skin), settings.triangles
    for _ in range(MAX_DECIMATIONS):
        fewer = surface.decimated(skin, wanted, head.baseMm)
        mesh = _cut(fewer, head.baseMm)
        # The base is not decimated with the rest; how many it adds shows only afterwards.
        over = len(mesh.triangles) - MAX_TRIANGLES
        if over <= 0:
            break
        wanted -= over + BASE_RESERVE
    _check(mesh)
    progress("Done", 1.0)
    return mesh


def _around(inside: np.ndarray, below: int) -> tuple[slice, slice, slice]:
    """Return the part of the image that the head needs; what is below and much air costs time."""
    spans = []
    for axis, count in enumerate(inside.shape):
        others = tuple(other for other in range(3) if other != axis)
        set_ = np.flatnonzero(inside.any(axis=others))
        spans.append((max(0, set_[0] - MARGIN), min(count, set_[-1] + 1 + MARGIN)))
    return slice(*spans[0]), slice(*spans[1]), slice(below, spans[2][1])


def _body(inside: np.ndarray, settings: HeadSettings, progress: Progress) -> np.ndarray:
    """Return the head without cavities and tunnels, as little filled as possible."""
    hull = mask.withoutCavities(mask.closedByBall(inside, settings.openingMm / 2))
    progress("Filling cavities", 0.45)
    depth = settings.cavityDepthMm / SPACING_MM
    deep = mask.depthInside(hull, depth) > depth
    wanted = mask.withoutCavities(inside | deep)
    progress("Closing tunnels", 0.55)
    ball = _ballLike(wanted, settings)
    progress("Closing tunnels", 0.7)
    return mask.carved(ball, wanted)


def _ballLike(wanted: np.ndarray, settings: HeadSettings) -> np.ndarray:
    """Return a body without tunnels around the wanted one."""
    for radius in settings.openingMm * np.array([0.5, 1.0, 2.0, 4.0]):
        body = mask.withoutCavities(mask.closedByBall(wanted, radius / SPACING_MM))
        contour = surface.meshOf(surface.surfaceOf(np.where(body, 1.0, -1.0), np.zeros(3), 1.0))
        if contour.euler_characteristic == 2:
            return body
    raise InputError("No head was found: the shape above the threshold has too many tunnels.")


def _agreeing(level: np.ndarray, body: np.ndarray) -> np.ndarray:
    """Return the level set, changed only where it disagrees with the body."""
    return np.where(body, np.maximum(level, 0.05), np.minimum(level, -0.05))


def _cut(skin: vtk.vtkPolyData, baseMm: float) -> HeadMesh:
    """Return the skin cut flat, a hair higher where triangles in the very plane keep it open."""
    for hair in HAIRS_MM:
        mesh = surface.meshOf(surface.cutFlat(skin, baseMm + hair))
        if _isSound(mesh):
            break
    return mesh


def _isSound(mesh: HeadMesh) -> bool:
    return mesh.is_closed and mesh.euler_characteristic == 2


def _check(mesh: HeadMesh) -> None:
    if not _isSound(mesh):
        raise InputError(
            "No head was found: its surface could not be closed; try another threshold or base."
        )
    if len(mesh.triangles) > MAX_TRIANGLES:
        raise InputError(
            f"The head's surface has {len(mesh.triangles)} triangles, more than {MAX_TRIANGLES}; "
            "aim at fewer."
        )
