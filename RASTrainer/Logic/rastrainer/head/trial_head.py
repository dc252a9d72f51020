"""The pose of the head in a trial, near the nominal one, and the shift of its skin.

Only the simulator knows either. Skin and scalp move on the skull when the head is positioned
differently, its holder is tightened or tape is stuck to it; bone, brain and targets stay.
The shift is smooth, seeded and of a stated size: a sum of waves of random directions (random
Fourier features), a normal field in space whose covariance is Gaussian in the distance: neighboring
places move alike. Its size and its reach are stated, not measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.random import default_rng

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh, nearest_vertices
from rastrainer.json_checks import number, whole_number
from rastrainer.protocol import SKIN_LIMIT_MM


@dataclass(frozen=True)
class Perturbation:
    """How far the head may be from its nominal pose: along each axis of World, about the vertical,
    and about a horizontal axis of any direction."""

    translation_mm: Annotated[float, number(0, 200, "mm")]
    yaw_deg: Annotated[float, number(0, 180, "°")]
    tilt_deg: Annotated[float, number(0, 45, "°")]


MAX_PERTURBATION = Perturbation(200.0, 180.0, 45.0)


def perturbed_pose(
    head_to_world: np.ndarray, pivot: np.ndarray, limits: Perturbation, seed: int
) -> np.ndarray:
    """Return the pose of the head for a seed, (4, 4) mm: rotated about a pivot, then moved."""
    random = default_rng(seed)
    shift = random.uniform(-limits.translation_mm, limits.translation_mm, 3)
    yaw = np.radians(random.uniform(-limits.yaw_deg, limits.yaw_deg))
    toward, tilt = random.uniform([0.0, 0.0], [2.0 * np.pi, np.radians(limits.tilt_deg)])
    lean = _rotation(np.array([np.cos(toward), np.sin(toward), 0.0]), tilt)
    turn = lean @ _rotation(np.array([0.0, 0.0, 1.0]), yaw)
    center = transforms.apply(head_to_world, pivot)
    return transforms.rigid(turn, center + shift - turn @ center) @ head_to_world


def _rotation(axis: np.ndarray, angle: float) -> np.ndarray:
    """Return the rotation (3, 3) about a unit vector by an angle in rad (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross


REACH_MM = 50.0
"""Places that far apart move with a correlation of exp(−½)."""
WAVES = 128
BASE_MM = 30.0
"""So far above the flat base, where the images end, the shift grows from none to all."""
_Amount = Annotated[float, number(0, SKIN_LIMIT_MM, "mm")]
INVERSIONS = 8
"""Steps that undo a shift; each leaves a part of the error, 4 % for 2 mm."""


@dataclass(frozen=True)
class SkinShift:
    """The shift of the skin in the operation, compared with the images.

    `shift_mm` is the root mean square length of the shift, over seeds; the seed is secret like the
    head's pose; `indentation_mm` is how deep the tip presses into the skin.
    """

    shift_mm: _Amount = 0.0
    seed: Annotated[int, whole_number(0, 2**63 - 1)] = 0
    indentation_mm: _Amount = 0.0

    def __post_init__(self) -> None:
        for name, value in (("skin shift", self.shift_mm), ("indentation", self.indentation_mm)):
            if not 0.0 <= value <= SKIN_LIMIT_MM:
                raise InputError(f"The {name} must be 0 to {SKIN_LIMIT_MM:g} mm, not {value:g} mm.")

    @property
    def is_none(self) -> bool:
        """Whether the skin lies as in the images."""
        return self.shift_mm == self.indentation_mm == 0.0

    @cached_property
    def _waves(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        random = np.random.default_rng([self.seed, WAVES])
        vectors = random.normal(0.0, 1.0 / REACH_MM, (WAVES, 3))
        phases = random.uniform(0.0, 2.0 * np.pi, WAVES)
        sizes = random.normal(0.0, self.shift_mm * np.sqrt(2.0 / (3.0 * WAVES)), (WAVES, 3))
        return vectors, phases, sizes

    def moved(self, points: np.ndarray, mesh: HeadMesh) -> np.ndarray:
        """Return by how much skin at points (n, 3) of the images has moved, (n, 3) mm."""
        points = np.asarray(points, dtype=float)
        if self.shift_mm == 0.0:
            return np.zeros_like(points)
        vectors, phases, sizes = self._waves
        field = np.cos(points @ vectors.T + phases) @ sizes
        above = np.clip((points[:, 2] - mesh.vertices[:, 2].min()) / BASE_MM, 0.0, 1.0)
        return np.asarray(field * (above**2 * (3.0 - 2.0 * above))[:, None])

    def touched(self, points: np.ndarray, normals: np.ndarray, mesh: HeadMesh) -> np.ndarray:
        """Return where the tip is when it touches skin at points of the images, (n, 3) mm."""
        return points + self.moved(points, mesh) - self.indentation_mm * normals

    def measured(self, points: np.ndarray, mesh: HeadMesh) -> np.ndarray:
        """Return where skin at points of the images is measured, (n, 3) float, RAS mm.

        It is indented along the normal of the nearest vertex.
        """
        if self.indentation_mm == 0.0:
            return points + self.moved(points, mesh)
        _, nearest = nearest_vertices(mesh, points)
        return self.touched(points, mesh.vertex_normals[nearest], mesh)

    def unmeasured(self, points: np.ndarray, mesh: HeadMesh) -> np.ndarray:
        """Return the points of the images that `measured` puts at points (n, 3), RAS mm."""
        found = np.asarray(points, dtype=float)
        for _ in range(INVERSIONS):
            found = found + points - self.measured(found, mesh)
        return found


UNMOVED = SkinShift()
"""The skin lies as in the images."""
