"""The whole way from a volume to a head that the simulator can train on."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from rastrainer.errors import InputError
from rastrainer.head_mesh import HeadMesh
from rastrainer.slicer.head import beyond_image, mask, surface, topology
from rastrainer.slicer.head.volume import Volume, on_ras_grid

SPACING_MM = 1.0
MARGIN = 14
"""Voxels added around the image, in which the nose and the ears may close."""

MOST_TRIANGLES = 60_000


@dataclass(frozen=True)
class HeadSettings:
    """What may be chosen about the extraction.

    Attributes:
        threshold: value that parts air from skin; None finds it (Otsu).
        base_mm: height (S) of the flat base; None for just above the image's lower edge.
        noise_mm: standard deviation of the smoothing of the image.
        cavity_depth_mm: what lies so deep below the skin is filled: airways, sinuses, ear canals.
        opening_mm: openings up to this width do not count as part of the skin's outside.
        triangles: how many are aimed at; the flat base adds a few.
    """

    threshold: float | None = None
    base_mm: float | None = None
    noise_mm: float = 1.0
    cavity_depth_mm: float = 4.0
    opening_mm: float = 12.0
    triangles: int = 55_000


def extract_head(
    volume: Volume,
    settings: HeadSettings | None = None,
    progress: Callable[[str, float], None] = lambda _step, _share: None,
) -> HeadMesh:
    """Return the skin as one closed surface of genus 0 with a flat base.

    Args:
        volume: T1-weighted MRI or CT of a head.
        settings: what to choose otherwise than usual.
        progress: told each step's name and the share of the work done; may raise to cancel.

    Raises:
        InputError: there is no head in the volume, or no closed surface could be made of it.
    """
    settings = settings or HeadSettings()
    progress("Reading the volume", 0.0)
    grid = on_ras_grid(volume, SPACING_MM)
    progress("Finding the skin", 0.1)
    level = beyond_image.continued(_level(grid.values, settings), MARGIN)
    progress("Filling cavities", 0.3)
    body = _body(level > 0, settings)
    progress("Making the surface", 0.8)
    lowest = grid.ijk_to_ras[2, 3]
    origin = grid.ijk_to_ras[:3, 3] - MARGIN * SPACING_MM
    skin = surface.smoothed(surface.surface_of(_agreeing(level, body), origin, SPACING_MM))
    base = lowest + SPACING_MM if settings.base_mm is None else settings.base_mm
    skin = surface.decimated(skin, settings.triangles, base)
    mesh = surface.mesh_of(surface.cut_flat(skin, base))
    _check(mesh)
    progress("Done", 1.0)
    return mesh


def _level(values: np.ndarray, settings: HeadSettings) -> np.ndarray:
    """Return a level set within ±1, positive in tissue, whose zero lies between the voxels."""
    smooth = ndimage.gaussian_filter(values, settings.noise_mm / SPACING_MM, mode="nearest")
    threshold = settings.threshold
    if threshold is None:
        threshold = mask.otsu_threshold(smooth)
    level = np.clip(smooth / threshold - 1.0, -1.0, 1.0)
    # Filled first: the skull's dark layer may part the scalp from a brain that is larger.
    head = mask.largest_body(mask.without_cavities(level > 0))
    return np.where(head | (level <= 0), level, -1.0).astype(np.float32)


def _body(tissue: np.ndarray, settings: HeadSettings) -> np.ndarray:
    """Return the head without cavities and tunnels, as little filled as possible."""
    hull = mask.without_cavities(mask.closed_by_ball(tissue, settings.opening_mm / 2))
    deep = mask.depth_inside(hull) > settings.cavity_depth_mm / SPACING_MM
    wanted = mask.without_cavities(tissue | deep)
    return topology.carved(_ball_like(wanted, settings), wanted)


def _ball_like(wanted: np.ndarray, settings: HeadSettings) -> np.ndarray:
    """Return a body without tunnels around the wanted one."""
    for radius in settings.opening_mm * np.array([0.5, 1.0, 2.0, 4.0]):
        body = mask.without_cavities(mask.closed_by_ball(wanted, radius / SPACING_MM))
        contour = surface.mesh_of(surface.surface_of(np.where(body, 1.0, -1.0), np.zeros(3), 1.0))
        if contour.euler_characteristic == 2:
            return body
    raise InputError("No head was found: the shape above the threshold has too many tunnels.")


def _agreeing(level: np.ndarray, body: np.ndarray) -> np.ndarray:
    """Return the level set, changed only where it disagrees with the body."""
    return np.where(body, np.maximum(level, 0.05), np.minimum(level, -0.05))


def _check(mesh: HeadMesh) -> None:
    if not mesh.is_closed or mesh.euler_characteristic != 2:
        raise InputError("The head's surface could not be closed; try another threshold or base.")
    if len(mesh.triangles) > MOST_TRIANGLES:
        raise InputError(
            f"The head's surface has {len(mesh.triangles)} triangles, more than {MOST_TRIANGLES}; "
            "aim at fewer."
        )
