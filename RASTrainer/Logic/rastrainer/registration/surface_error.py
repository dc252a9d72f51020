"""The target error to expect of a surface match, and where on the skin a point would help most.

The curvature of the cost at its minimum is H = Σ JᵢᵀJᵢ with Jᵢ = (nᵢ, (pᵢ − c) × nᵢ): what each
point reveals about the pose. With the variance σ² of the points across the skin, σ²H⁻¹ is the
covariance of the pose. Both are to first order, and for errors that are independent: a shift of the
skin is not.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.surface_match import SurfaceMatch
from rastrainer.registration.target_error import (
    COMMON_BIAS_SD_MM,
    CONFIDENCE,
    TargetError,
    error_of_covariance,
)

PARAMETERS = 6
UNKNOWN_MM, UNKNOWN_RAD = 10.0, 0.2
"""Standard deviations of a pose before the first point, on each axis: what landmarks leave open."""
USUAL_NOISE_MM = 0.5
DAB = 10
"""Points that are drawn where the next place is: one centimeter of way."""


@dataclass(frozen=True, eq=False)
class PoseKnowledge:
    """What points on the skin reveal about the head's pose.

    Attributes:
        center: (3,) float, RAS mm, about which rotations are taken.
        curvature: (6, 6) float, H for translation (mm) and rotation (rad).
        noise_mm: σ of a point across the skin.
        degrees_of_freedom: How well σ is known.
    """

    center: np.ndarray
    curvature: np.ndarray
    noise_mm: float
    degrees_of_freedom: float

    @property
    def covariance(self) -> np.ndarray:
        """(6, 6) float: that of the pose."""
        return self.noise_mm**2 * np.linalg.inv(self.curvature)

    def at_targets(self, targets: np.ndarray) -> np.ndarray:
        """Return the covariances (m, 3, 3), mm², of the error at targets (m, 3), RAS mm."""
        moved = _moves(targets - self.center)
        return moved @ self.covariance @ np.swapaxes(moved, 1, 2)


def knowledge_of(match: SurfaceMatch) -> PoseKnowledge:
    """Return what a match reveals about the pose: from its points that count, and their residuals.

    σ² is Σ r²/(n − 6): the fit takes six parameters from the residuals.

    Raises:
        InputError: the trace leaves the pose open.
    """
    places = (match.nearest_mm + match.residual_vectors_mm)[match.is_inlier]
    count = len(places)
    rows, center = _rows(places, match.normals[match.is_inlier])
    curvature = rows.T @ rows
    if np.linalg.cond(curvature) > 1e12:
        raise InputError(
            "The trace leaves the head free to turn or slide; trace places that face other ways."
        )
    squares = float(np.sum(match.residuals_mm[match.is_inlier] ** 2))
    dof = count - PARAMETERS
    return PoseKnowledge(center, curvature, float(np.sqrt(squares / dof)), dof)


def knowledge_so_far(
    places: np.ndarray, normals: np.ndarray, mesh: HeadMesh, noise_mm: float = USUAL_NOISE_MM
) -> PoseKnowledge:
    """Return what the points of an unfinished trace reveal, however few; nothing without points.

    Before the first point, a pose is known to 10 mm and 0.2 rad on each axis.

    Args:
        places: (n, 3) float, RAS mm, where the points lie by the pose known so far.
        normals: (n, 3) float, unit normals of the skin there.
        mesh: The head.
        noise_mm: σ, assumed.
    """
    rows, center = _rows(np.reshape(places, (-1, 3)), np.reshape(normals, (-1, 3)), mesh.middle)
    known = np.diag([(noise_mm / UNKNOWN_MM) ** 2] * 3 + [(noise_mm / UNKNOWN_RAD) ** 2] * 3)
    return PoseKnowledge(center, rows.T @ rows + known, noise_mm, np.inf)


def surface_target_error(
    knowledge: PoseKnowledge,
    target: np.ndarray,
    confidence: float = CONFIDENCE,
    common_bias_sd_mm: float = COMMON_BIAS_SD_MM,
) -> TargetError:
    """Return the error to expect at a target (3,), RAS mm, with its interval.

    An offset that all points share, such as that of the tip's calibration, moves the whole head and
    adds 3σ² of its standard deviation on each axis, as with fiducials. The interval is that of
    fiducials, too (`rastrainer.registration.target_error.target_error`), and has the same blind
    spots: errors that neighboring points share.
    """
    return error_of_covariance(
        target,
        knowledge.at_targets(np.reshape(target, (1, 3)))[0],
        fle_mm=knowledge.noise_mm,
        degrees_of_freedom=knowledge.degrees_of_freedom,
        confidence=confidence,
        common_bias_sd_mm=common_bias_sd_mm,
    )


@dataclass(frozen=True)
class NextPlace:
    """Where on the skin more points would help most.

    Attributes:
        vertex: Of the mesh.
        position: (3,) float, RAS mm.
    """

    vertex: int
    position: np.ndarray


def next_best_place(
    knowledge: PoseKnowledge, mesh: HeadMesh, targets: np.ndarray, allowed: np.ndarray
) -> NextPlace:
    """Return the place whose points would reduce the expected TRE most.

    k points at a place with the row J change the covariance C = H⁻¹ by
    −k·CJᵀJC/(1 + k·JCJᵀ) (Sherman and Morrison 1950), so all places are compared at once.

    Args:
        knowledge: Of the points so far.
        mesh: The head.
        targets: (m, 3) float, RAS mm.
        allowed: (v,) bool, the vertices that can be reached, at least one.

    Raises:
        InputError: no vertex is allowed.
    """
    rows = np.flatnonzero(allowed)
    if not len(rows):
        raise InputError("No place on the skin can be reached.")
    moved = _moves(np.asarray(targets, dtype=float) - knowledge.center)
    weight = np.einsum("tij,tik->jk", moved, moved) / len(moved)
    inverse = np.linalg.inv(knowledge.curvature)
    directions, _ = _rows(mesh.vertices[rows], mesh.vertex_normals[rows], knowledge.center)
    turned = directions @ inverse
    gain = DAB * np.einsum("vi,ij,vj->v", turned, weight, turned)
    gain /= 1.0 + DAB * np.einsum("vi,vi->v", turned, directions)
    best = int(gain.argmax())
    return NextPlace(int(rows[best]), mesh.vertices[rows[best]])


def _rows(
    places: np.ndarray, normals: np.ndarray, center: np.ndarray | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Return what each point reveals about the pose, J (n, 6), and the center of rotations (3,)."""
    middle = places.mean(axis=0) if center is None else center
    return np.concatenate([normals, np.cross(places - middle, normals)], axis=1), middle


def _moves(arms: np.ndarray) -> np.ndarray:
    """Return how points (m, 3), from the center, move with the pose, (m, 3, 6) float."""
    turned = np.swapaxes(np.cross(np.eye(3), arms[:, None, :]), 1, 2)
    return np.concatenate([np.broadcast_to(np.eye(3), (len(arms), 3, 3)), turned], axis=2)
