"""How exactly each method of registration finds its points (docs/registration-methods.md).

A scan is simulated: a range camera sees where its rays first meet the skin, with noise along them.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.random import Generator

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.procedure.geometry import mesh_crossings
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.surface_checks import LEAST_POINTS
from rastrainer.transforms import frame_along

PUBLISHED_NOISE: Mapping[RegistrationMethod, float] = {
    RegistrationMethod.BONE_SCREWS: 0.5,
    RegistrationMethod.FIDUCIALS: 1.5,
    RegistrationMethod.LANDMARKS: 4.0,
    RegistrationMethod.SURFACE: 0.5,
    RegistrationMethod.LANDMARKS_SURFACE: 0.5,
    RegistrationMethod.SCAN: 1.07,
}
"""In mm: of a touched point, the RMS length of its error (FLE); of a traced or scanned point, the
standard deviation across the skin or along the ray."""


@dataclass(frozen=True, eq=False)
class RangeCamera:
    """A camera before the head; its points are `spacing_mm` apart on skin that faces it."""

    eye: np.ndarray
    noise_mm: float
    spacing_mm: float = 8.0

    def seen(self, mesh: HeadMesh) -> np.ndarray:
        """Return the points of the skin at which the rays end, (n, 3) float, RAS mm, exact.

        The rays go through a square grid at distance 1 before the eye. Where ears, nose or brows
        hide the skin behind them, the rays end on these.
        """
        ahead = mesh.middle - self.eye
        away = float(np.linalg.norm(ahead))
        spacing, frame = self.spacing_mm / away, frame_along(ahead / away)
        skin, points = mesh.skin, []
        seen = (skin.vertices - self.eye) @ frame.T
        on_grid = seen[:, :2] / seen[:, 2:] / spacing
        low, high = np.floor(on_grid.min(axis=0)), np.ceil(on_grid.max(axis=0))
        farthest_mm = float(np.linalg.norm(seen, axis=1).max())
        for place in itertools.product(*map(np.arange, low, high + 1)):
            ray = np.array([*place, 1.0 / spacing]) @ frame
            ray /= np.linalg.norm(ray)
            if crossings := mesh_crossings(skin, self.eye, ray, farthest_mm):
                points.append(self.eye + crossings[0].distance_mm * ray)
        if len(points) < LEAST_POINTS:
            raise InputError(
                f"The range camera sees {len(points)} points of the head; a match needs "
                f"{LEAST_POINTS}: place the camera in front of the face, or its points closer "
                "together."
            )
        return np.array(points)

    def noisy(self, points: np.ndarray, random: Generator) -> np.ndarray:
        """Return points (n, 3), RAS mm, as the camera measures them."""
        rays = points - self.eye
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        return points + random.normal(0.0, self.noise_mm, (len(points), 1)) * rays
