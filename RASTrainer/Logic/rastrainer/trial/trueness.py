"""Trueness of a trial's touches: the bias along the skin that all of them share.

Accuracy is precision and trueness (ISO 5725-1). The error of a registration in the brain says
little about trueness: on a small patch of skin, a bias that all touches share is nearly a rotation
about the center of the head, which hardly moves the brain. So the bias is estimated from the true
errors of the touches, which only a simulator knows.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.registration.distributions import f_tail

LEAST_SHARE_ALONG_SKIN = 0.1
"""Directions that lead off the skin at nearly all fiducials are left out: a bias there moves no
touch, and its estimate would be noise. The squared share along the skin is the mean over the
fiducials; it is at least 0.25 for every direction and task of Colin27."""
LEVEL = 0.05


@dataclass(frozen=True)
class CommonBias:
    """The common bias of a trial's touches.

    Attributes:
        vector_mm: in RAS, from where the trainee should have touched to where the touches are.
        p: probability of one at least as large if the errors are independent, unbiased and equal
            along the skin (F test).
    """

    vector_mm: tuple[float, float, float]
    p: float

    @property
    def length_mm(self) -> float:
        """Its length."""
        return float(np.linalg.norm(self.vector_mm))

    @property
    def is_shown(self) -> bool:
        """Whether it is larger than the scatter of the touches explains."""
        return self.p < LEVEL


def true_touch_errors(
    touches_mm: np.ndarray, head_to_world: np.ndarray, fiducials_mm: np.ndarray
) -> np.ndarray:
    """Return how far touches are from their fiducials, (n, 3) float, RAS mm.

    Args:
        touches_mm: (n, 3) float, World mm.
        head_to_world: (4, 4) float, mm, the true pose.
        fiducials_mm: (n, 3) float, RAS mm, paired with the touches.

    Raises:
        InputError: the pose has no inverse.
    """
    try:
        world_to_head = transforms.inverse(head_to_world)
    except np.linalg.LinAlgError:
        raise InputError("The true pose of the head must be a rigid transform.") from None
    return transforms.apply(world_to_head, touches_mm) - fiducials_mm


def common_bias(errors_mm: np.ndarray, normals: np.ndarray) -> CommonBias:
    """Return the bias that best explains the errors of touches along the skin.

    Args:
        errors_mm: (n, 3) float, as `true_touch_errors` returns them.
        normals: (n, 3) float, unit normals of the skin at the fiducials, in the same frame.
    """
    along = _along_skin(normals)
    bias = np.einsum("inj,nj->i", bias_of_errors(normals), errors_mm)
    explained = float(np.sum((along @ bias) ** 2))
    left = float(np.sum(np.einsum("nij,nj->ni", along, errors_mm) ** 2)) - explained
    known = _axes(along)[0].size
    # Each error has two components along the skin.
    dof = 2 * len(normals) - known
    ratio = explained / known * dof / left if left > 0 else np.inf if explained > 0 else 0.0
    x, y, z = (float(value) for value in bias)
    return CommonBias((x, y, z), f_tail(ratio, known, dof))


def bias_of_errors(normals: np.ndarray) -> np.ndarray:
    """Return the linear map from the errors of touches to their common bias, (3, n, 3) float.

    It is that of least squares, b = (Σ Pᵢ)⁻¹ Σ Pᵢ eᵢ with Pᵢ = I − nᵢnᵢᵀ: what leads into the skin
    or off it moves no touch.

    Args:
        normals: (n, 3) float, unit normals of the skin at the fiducials.
    """
    along = _along_skin(normals)
    shares, axes = _axes(along)
    return np.einsum("ij,njk->ink", axes / shares @ axes.T, along) / len(normals)


def _along_skin(normals: np.ndarray) -> np.ndarray:
    """Return the projections onto the skin, (n, 3, 3) float."""
    return np.eye(3) - normals[:, :, None] * normals[:, None, :]


def _axes(along: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the shares, (k,) float, and the axes along which a bias moves touches, (3, k)."""
    shares, axes = np.linalg.eigh(along.mean(axis=0))
    kept = shares >= LEAST_SHARE_ALONG_SKIN
    return shares[kept], axes[:, kept]
