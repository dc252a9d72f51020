"""How far a match to the surface may slide along the skin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.head.mesh import HeadMesh

LEAST_NOISE_MM, ALIKE_MM = 1.0, 20.0
"""Standard deviation of what all points within a cube of so many mm are off alike, as skin is
pressed and drawn along. Residuals do not show it, and more points in one place do not reduce it."""
TARGETS_ASIDE_MM = 30.0
"""Of the places in the brain where a slide is measured, from the head's middle along each axis."""
NORMAL_95 = 1.96
_LOOSEST_MM = 100.0
_DIRECTIONS = ("left or right", "forward or back", "up or down")
_SIDES = {
    "front": (0.0, 1.0, 0.0),
    "back": (0.0, -1.0, 0.0),
    "left": (-1.0, 0.0, 0.0),
    "right": (1.0, 0.0, 0.0),
    "top": (0.0, 0.0, 1.0),
}


@dataclass(frozen=True)
class SurfaceSlide:
    """How far a match may slide along the skin.

    Attributes:
        distance_mm: With 95 % probability, no target in the brain is off by more in this
            direction.
        place: Where on the head it is largest: `front`, `back`, `left`, `right` or `top`.
        direction: Unit vector, RAS, at the targets.
    """

    distance_mm: float
    place: str
    direction: tuple[float, float, float]

    @property
    def way(self) -> str:
        """The direction in words."""
        return _DIRECTIONS[int(np.abs(self.direction).argmax())]


def slide_of(
    places: np.ndarray, normals: np.ndarray, rms_mm: float, mesh: HeadMesh
) -> SurfaceSlide:
    """Return how far a head may slide under points that its surface fits.

    The curvature of the cost is H = Σ wᵢ JᵢᵀJᵢ with J = (n, (p − c) × n); σ²H⁻¹ is the covariance
    of the pose. All points within a cube of 20 mm count as one, w = 1/their number, as their errors
    are alike. The covariance is propagated to the middle of the head and six places around it. The
    largest eigenvalue among them, as a 95 % limit, is the answer; it ends at 100 mm.

    Args:
        places: (n, 3) float, RAS mm, the points where the match puts them.
        normals: (n, 3) float, the directions in which their distances grow.
        rms_mm: σ, of the residuals; at least 1 mm.
        mesh: The head.
    """
    noise = max(rms_mm, LEAST_NOISE_MM)
    center = places.mean(axis=0)
    rows = np.concatenate([normals, np.cross(places - center, normals)], axis=1)
    half = mesh.size / 2.0
    prior = (noise / _LOOSEST_MM) ** 2 * np.diag([1.0] * 3 + [float(half.max()) ** 2] * 3)
    weighted = rows * _shares_of_cubes(places)[:, None]
    covariance = noise**2 * np.linalg.inv(weighted.T @ rows + prior)
    steps = TARGETS_ASIDE_MM * np.vstack([np.zeros(3), np.eye(3), -np.eye(3)])
    variance, direction = max(
        (_largest_move(covariance, mesh.middle + step - center) for step in steps),
        key=lambda one: one[0],
    )
    sides = {
        place: _largest_move(covariance, mesh.middle + half * side - center)[0]
        for place, side in _SIDES.items()
    }
    x, y, z = (float(value) for value in direction)
    return SurfaceSlide(
        NORMAL_95 * float(np.sqrt(variance)), max(sides, key=lambda place: sides[place]), (x, y, z)
    )


def _shares_of_cubes(places: np.ndarray) -> np.ndarray:
    """Return 1/number of the points (n, 3) in the same cube as each, (n,) float."""
    cubes = np.floor(places / ALIKE_MM).astype(int)
    _, which, counts = np.unique(cubes, axis=0, return_inverse=True, return_counts=True)
    return np.asarray(1.0 / counts[which.reshape(-1)])


def _largest_move(covariance: np.ndarray, arm: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the largest variance, mm², and its direction, at an arm (3,) from the center."""
    moves = np.concatenate([np.eye(3), -_cross(arm)], axis=1)
    values, vectors = np.linalg.eigh(moves @ covariance @ moves.T)
    return float(values[-1]), vectors[:, -1]


def _cross(vector: np.ndarray) -> np.ndarray:
    """Return the matrix (3, 3) of the cross product with a vector."""
    x, y, z = vector
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
