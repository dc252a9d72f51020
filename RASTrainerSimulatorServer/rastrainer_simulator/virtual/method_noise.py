"""How exactly each method of registration finds its points, and what was published of its error.

What was measured in patients is the error at a target, not that of a point. Only the figures of
`source` are published; where it says so, the error of a point is our own assumption.

A scan is simulated: a range camera sees where its rays first meet the skin, with noise along them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.random import Generator

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.protocol import RegistrationMethod
from rastrainer.registration.surface_checks import LEAST_POINTS

MONGEN_2019 = (
    "Mongen and Willems 2019, Acta Neurochirurgica, doi:10.1007/s00701-019-03867-8: eleven patients"
)
MULTIMODALITY_1999 = (
    "“Clinical evaluation of multimodality registration in frameless stereotaxy”: 44 patients"
)
SKULL_BASE_PAGE = (
    "“Registration”, www.alpfmedical.info/skull-base/registration.html, of unknown year: "
    "experience of one group"
)
LASER_2003 = (
    "Laser study of 2003, doi:10.1055/s-2003-40811: 25 registrations each on a model of a skull"
)
REALSENSE_2017 = (
    "ten Harkel et al., “Depth accuracy of the RealSense F200”: 34 patients, 1.07 mm at 35 cm"
)
_MARGIN = 1e-9
SPACING_MM = 8.0
"""Between points of a scan that faces the camera."""


@dataclass(frozen=True)
class MethodNoise:
    """The noise of a method.

    Attributes:
        point_mm: Of a touched point, the RMS length of its error (FLE); of a traced or scanned
            point, the standard deviation across the skin or along the ray.
        source: Where `point_mm` is from.
        published: What was measured at a target, with its source; "" if nothing is cited.
        is_on_skin: Whether the method's points move with the skin.
    """

    point_mm: float
    source: str
    published: str
    is_on_skin: bool = True


PUBLISHED_NOISE: Mapping[RegistrationMethod, MethodNoise] = MappingProxyType(
    {
        RegistrationMethod.BONE_SCREWS: MethodNoise(
            0.5,
            "our assumption: no skin between screw and bone",
            f"below 1 mm ({SKULL_BASE_PAGE})",
            is_on_skin=False,
        ),
        RegistrationMethod.FIDUCIALS: MethodNoise(
            1.5,
            "the published RMSE of 1.4 mm over fifteen fiducials, on which the score is based",
            f"2.49 mm (mean; {MONGEN_2019}); 1.6 ± 0.1 mm ({MULTIMODALITY_1999})",
        ),
        RegistrationMethod.LANDMARKS: MethodNoise(
            4.0,
            f"middle of 3 to 5 mm, at best ({SKULL_BASE_PAGE})",
            f"3.4 ± 0.4 mm ({MULTIMODALITY_1999})",
        ),
        RegistrationMethod.SURFACE: MethodNoise(
            0.5, "our assumption, as of the guidance", f"5.35 mm (mean; {MONGEN_2019})"
        ),
        RegistrationMethod.LANDMARKS_SURFACE: MethodNoise(0.5, "as of the surface", ""),
        RegistrationMethod.SCAN: MethodNoise(
            1.07, REALSENSE_2017, f"2.08 ± 0.49 mm ({LASER_2003})"
        ),
    }
)


def first_hits(mesh: HeadMesh, eye: np.ndarray, ahead: np.ndarray, spacing: float) -> np.ndarray:
    """Return where the rays of a camera first meet a surface, (n, 3) float, RAS mm.

    The rays go through the points of a square grid at distance 1 before the eye; those that meet
    nothing give no point. Each triangle is tried with the rays within the box around its picture
    (ray and triangle by Möller and Trumbore 1997), and the nearest hit of each ray is kept.

    Args:
        eye: (3,) float, RAS mm, outside of it.
        spacing: Of the grid: the tangent of the angle between neighboring rays in the middle.
    """
    frame = _frame(np.asarray(ahead, dtype=float))
    seen = (mesh.vertices - eye) @ frame.T
    corners = seen[mesh.triangles]
    corners = corners[(corners[:, :, 2] > _MARGIN).all(axis=1)]
    flat = corners[:, :, :2] / corners[:, :, 2:] / spacing
    low = np.ceil(flat.min(axis=1) - _MARGIN).astype(np.int64)
    sizes = np.maximum(np.floor(flat.max(axis=1) + _MARGIN).astype(np.int64) - low + 1, 0)
    counts = sizes.prod(axis=1)
    which = np.repeat(np.arange(len(corners)), counts)
    place = np.arange(len(which)) - np.repeat(np.cumsum(counts) - counts, counts)
    column, row = np.divmod(place, np.maximum(sizes[which, 1], 1))
    grid = low[which] + np.stack([column, row], axis=1)
    rays = np.concatenate([grid * spacing, np.ones((len(grid), 1))], axis=1)
    depth = _depths(corners[which], rays)
    is_hit = np.isfinite(depth)
    grid, rays, depth = grid[is_hit], rays[is_hit], depth[is_hit]
    order = np.lexsort((depth, grid[:, 1], grid[:, 0]))
    is_first = np.ones(len(order), dtype=bool)
    is_first[1:] = (np.diff(grid[order], axis=0) != 0).any(axis=1)
    nearest = order[is_first]
    return np.asarray(eye + (depth[nearest, None] * rays[nearest]) @ frame)


def _frame(ahead: np.ndarray) -> np.ndarray:
    """Return the axes of a camera as rows, (3, 3) float: right, up, ahead."""
    ahead = ahead / np.linalg.norm(ahead)
    right = np.cross(ahead, np.eye(3)[np.abs(ahead).argmin()])
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(ahead, right), ahead])


def _depths(corners: np.ndarray, rays: np.ndarray) -> np.ndarray:
    """Return the depth at which rays (n, 3) meet triangles (n, 3, 3), inf where they do not."""
    a = corners[:, 0]
    to_b, to_c = corners[:, 1] - a, corners[:, 2] - a
    across = np.cross(rays, to_c)
    determinant = np.einsum("ij,ij->i", to_b, across)
    safe = np.where(np.abs(determinant) > 1e-12, determinant, np.inf)
    u = -np.einsum("ij,ij->i", a, across) / safe
    turned = np.cross(-a, to_b)
    v = np.einsum("ij,ij->i", rays, turned) / safe
    depth = np.einsum("ij,ij->i", to_c, turned) / safe
    is_inside = (u >= -_MARGIN) & (v >= -_MARGIN) & (u + v <= 1 + _MARGIN) & np.isfinite(safe)
    return np.where(is_inside & (depth > 0), depth, np.inf)


@dataclass(frozen=True, eq=False)
class RangeCamera:
    """A camera before the head.

    Attributes:
        spacing_mm: Between points on skin that faces the camera.
    """

    eye: np.ndarray
    noise_mm: float
    spacing_mm: float = SPACING_MM

    def seen(self, mesh: HeadMesh) -> np.ndarray:
        """Return the points of the skin at which the rays end, (n, 3) float, RAS mm, exact.

        Where ears, nose or brows hide the skin behind them, the rays end on these.
        """
        ahead = mesh.middle - self.eye
        spacing = self.spacing_mm / float(np.linalg.norm(ahead))
        points = first_hits(mesh.skin, self.eye, ahead, spacing)
        if len(points) < LEAST_POINTS:
            raise InputError(
                f"The range camera sees {len(points)} points of the head; a match needs "
                f"{LEAST_POINTS}: place the camera in front of the face, or its points closer "
                "together."
            )
        return points

    def noisy(self, points: np.ndarray, random: Generator) -> np.ndarray:
        """Return points (n, 3), RAS mm, as the camera measures them."""
        rays = points - self.eye
        rays /= np.linalg.norm(rays, axis=1, keepdims=True)
        return points + random.normal(0.0, self.noise_mm, (len(points), 1)) * rays
