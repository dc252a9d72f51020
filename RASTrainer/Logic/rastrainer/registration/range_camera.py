"""A simulated range camera: it sees the skin that nothing hides, with noise along its rays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.ray_casting import first_hits
from rastrainer.registration.surface_checks import LEAST_POINTS

SPACING_MM = 8.0
"""Between points of a scan that faces the camera."""


@dataclass(frozen=True, eq=False)
class RangeCamera:
    """A camera before the head.

    Attributes:
        eye: (3,) float, RAS mm.
        noise_mm: Standard deviation of a distance, along the ray.
        spacing_mm: Between points on skin that faces the camera.
    """

    eye: np.ndarray
    noise_mm: float
    spacing_mm: float = SPACING_MM

    def seen(self, mesh: HeadMesh) -> np.ndarray:
        """Return the points of the skin at which the rays end, (n, 3) float, RAS mm, exact.

        Where ears, nose or brows hide the skin behind them, the rays end on these.

        Raises:
            InputError: fewer points than a surface match needs.
        """
        ahead = mesh.middle - self.eye
        spacing = self.spacing_mm / float(np.linalg.norm(ahead))
        points = first_hits(mesh.skin, self.eye, ahead, spacing)
        if len(points) < LEAST_POINTS:
            raise InputError(
                f"The range camera sees {len(points)} points of the head; a match needs "
                f"{LEAST_POINTS}: put the camera before the face, or its points closer together."
            )
        return points

    def scan(self, mesh: HeadMesh, random: Generator) -> np.ndarray:
        """Return the points that the camera measures, (n, 3) float, RAS mm.

        Raises:
            InputError: as of `seen`.
        """
        return self.noisy(self.seen(mesh), random)

    def noisy(self, points: np.ndarray, random: Generator) -> np.ndarray:
        """Return points (n, 3), RAS mm, as the camera measures them."""
        rays = points - self.eye
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        return points + random.normal(0.0, self.noise_mm, (len(points), 1)) * rays
