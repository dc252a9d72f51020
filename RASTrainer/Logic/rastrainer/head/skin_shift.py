"""A shift of the skin between imaging and operation: smooth, seeded, and of a stated size.

Skin and scalp move on the skull when the head is laid down otherwise, when its holder is tightened
or tape is stuck to it, while bone, brain and targets stay. The shift is a sum of waves of random
directions (random Fourier features), a normal field in space whose covariance is Gaussian in the
distance: neighboring places move alike. Its size and its reach are stated, not measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh

REACH_MM = 50.0
"""Places that far apart move with a correlation of exp(−½)."""
WAVES = 128
BASE_MM = 30.0
"""So far above the flat base, where the images end, the shift grows from none to all."""
LARGEST_MM = 20.0


@dataclass(frozen=True)
class SkinShift:
    """How the skin lies in the operation, compared with the images.

    Attributes:
        rms_mm: Root mean square length of the shift, over seeds; 0 for none.
        seed: Which shift.
        indentation_mm: How deep the tip presses into the skin.

    Raises:
        InputError: on construction, if a length is not within 0 to 20 mm.
    """

    rms_mm: float = 0.0
    seed: int = 0
    indentation_mm: float = 0.0

    def __post_init__(self) -> None:
        for name, value in (("skin shift", self.rms_mm), ("indentation", self.indentation_mm)):
            if not 0.0 <= value <= LARGEST_MM:
                raise InputError(f"The {name} must be 0 to {LARGEST_MM:g} mm, not {value:g} mm.")

    @cached_property
    def _waves(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        random = np.random.default_rng([self.seed, WAVES])
        vectors = random.normal(0.0, 1.0 / REACH_MM, (WAVES, 3))
        phases = random.uniform(0.0, 2.0 * np.pi, WAVES)
        sizes = random.normal(0.0, self.rms_mm * np.sqrt(2.0 / (3.0 * WAVES)), (WAVES, 3))
        return vectors, phases, sizes

    def moved(self, points: np.ndarray, mesh: HeadMesh) -> np.ndarray:
        """Return by how much skin at points (n, 3) of the images has moved, (n, 3) float, mm.

        Args:
            points: RAS mm.
            mesh: The head of the images; at its base the shift is none.
        """
        points = np.asarray(points, dtype=float)
        if self.rms_mm == 0.0:
            return np.zeros_like(points)
        vectors, phases, sizes = self._waves
        field = np.cos(points @ vectors.T + phases) @ sizes
        above = np.clip((points[:, 2] - mesh.vertices[:, 2].min()) / BASE_MM, 0.0, 1.0)
        return np.asarray(field * (above**2 * (3.0 - 2.0 * above))[:, None])

    def touched(self, points: np.ndarray, normals: np.ndarray, mesh: HeadMesh) -> np.ndarray:
        """Return where the tip is when it touches skin at points of the images, (n, 3) float, RAS.

        Args:
            points: (n, 3) float, RAS mm.
            normals: (n, 3) float, outward unit normals of the skin there.
            mesh: The head of the images.
        """
        return points + self.moved(points, mesh) - self.indentation_mm * normals
