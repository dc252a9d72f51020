"""A head as voxels, and what may be chosen about finding it; quick to import."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

SPACING_MM = 1.0
"""Of the voxels."""
BELOW_BASE_MM = 3.0
"""How far a segment continues below the base, so that its end does not affect the cut."""


@dataclass(frozen=True)
class HeadSettings:
    """What may be chosen about the extraction.

    Attributes:
        threshold: value that parts air from skin; None finds it (Otsu; −475 HU of a CT).
        baseMm: height (S) of the flat base; None for just above the image's lower edge, or the
            neck.
        noiseMm: standard deviation of the smoothing of the image.
        cavityDepthMm: what lies so deep below the skin is filled: airways, sinuses, ear canals.
        openingMm: openings up to this width do not count as part of the skin's outside.
        triangles: how many are aimed at; the flat base adds a few.
    """

    threshold: float | None = None
    baseMm: float | None = None
    noiseMm: float = 1.0
    cavityDepthMm: float = 4.0
    openingMm: float = 12.0
    triangles: int = 55_000


@dataclass(frozen=True)
class HeadBody:
    """A head as voxels of 1 mm along RAS, before it becomes a surface.

    Attributes:
        level: (i, j, k) float, positive inside, its zero between the voxels where the skin is.
        body: (i, j, k) bool, without cavities and tunnels.
        origin: (3,) float, RAS mm, of voxel 0, 0, 0.
        baseMm: height (S) of the flat base.
        threshold: that parts air from skin, in the volume's own values.
        isCt: whether the values are Hounsfield units.
    """

    level: np.ndarray
    body: np.ndarray
    origin: np.ndarray
    baseMm: float
    threshold: float
    isCt: bool

    @cached_property
    def labels(self) -> tuple[np.ndarray, np.ndarray]:
        """The body as a segment has it, and where its first voxel is.

        (k, j, i) uint8, 1 inside, down to 3 mm below the base; (3,) float, RAS mm. Made once, which
        takes a moment.
        """
        below = max(0, round((self.baseMm - BELOW_BASE_MM - self.origin[2]) / SPACING_MM))
        voxels = np.ascontiguousarray(self.body[:, :, below:].transpose(2, 1, 0), np.uint8)
        return voxels, self.origin + np.array([0.0, 0.0, below * SPACING_MM])
