"""How far a surface match can be trusted: unusable input, how far it may slide, and warnings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.point_list import points_of
from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.fits import RIGID, extents, motions
from rastrainer.registration.warnings import RegistrationWarning

LEAST_POINTS, MOST_USED, MOST_POINTS = 30, 500, 100_000
LEAST_EXTENT_MM = 10.0
"""RMS extent of a trace along its longest axis; a smaller one is a dab in one spot."""
FAR_OFF_MM = 50.0
HEAD_EXTENT_MM = (80.0, 500.0)
"""Limits of the longest side of the box around a head, mm."""

SLIDE_LIMIT_MM = 3.5
LEAST_INLIER_SHARE = 0.8
POOR_RMS_MM = 2.5
LEAST_BEST_SHARE = 0.5
FAR_POINT_MM = 3.0


@dataclass(frozen=True, eq=False)
class SurfaceMatch:
    """The fit of a trace to the surface of a head, and how far it can be trusted.

    Attributes:
        matrix: (4, 4) float, rigid, World→RAS.
        places_mm: (n, 3) float, RAS, where it puts the points that were given.
        residuals_mm: (n,) float, their distances to the surface.
        normals: (n, 3) float, RAS, unit directions in which the residuals grow.
        is_inlier: (n,) bool, whether a point counts; the others are too far off.
        rms_mm: Root mean square of the inliers' residuals. It does not predict the target error.
        converged: Whether the best fit has stopped moving.
        best_starts: How many of the starts ended in the best minimum.
        spread_mm: Largest distance at the head's center between the best and where another start
            ended.
        rivals: Number of minima elsewhere whose cost is at most twice the best minimum's.
        slide: The direction in which the trace determines the head least.
    """

    matrix: np.ndarray
    places_mm: np.ndarray
    residuals_mm: np.ndarray
    normals: np.ndarray
    is_inlier: np.ndarray
    rms_mm: float
    inlier_share: float
    converged: bool
    starts: int
    best_starts: int
    spread_mm: float
    rivals: int
    slide: SurfaceSlide

    @property
    def warnings(self) -> tuple[RegistrationWarning, ...]:
        """Warnings to show before the match is accepted."""
        return tuple(find_match_warnings(self))


def check_trace(trace_mm: object) -> np.ndarray:
    """Return a copy of a trace, (n, 3) float, that cannot be written to."""
    trace = points_of(trace_mm, "The trace cannot be used")
    if not LEAST_POINTS <= len(trace) <= MOST_POINTS:
        raise InputError(
            f"A surface match needs {LEAST_POINTS} to {MOST_POINTS} points, one for each "
            f"millimeter drawn over the skin; the trace has {len(trace)}."
        )
    along = extents(trace)[0]
    if along < LEAST_EXTENT_MM:
        raise InputError(
            f"The trace stays in one place (RMS extent {along:.1f} mm); draw it over forehead, "
            "nose, cheeks and temples."
        )
    return trace


def check_surface(mesh: HeadMesh) -> None:
    """Check that a mesh is the closed surface of a head."""
    extent = float(mesh.size.max())
    least, most = HEAD_EXTENT_MM
    if not least <= extent <= most:
        raise InputError(
            f"The surface is {extent:.4g} mm long; that of a head, in millimeters, is {least:.0f} "
            f"to {most:.0f} mm long."
        )
    if not mesh.is_closed:
        raise InputError(
            "The head's surface has holes or flipped triangles; a match needs a closed one: make "
            "the scenario's head again from its images."
        )


def check_start(start: object, trace: np.ndarray, mesh: HeadMesh) -> np.ndarray:
    """Return a copy of a start, (4, 4) float."""
    try:
        matrix = np.array(start, dtype=float)
    except (TypeError, ValueError, OverflowError):
        matrix = np.zeros(0)
    if matrix.shape != (4, 4) or not np.isfinite(matrix).all() or not transforms.is_rigid(matrix):
        raise InputError("The start of a surface match must be a rigid 4×4 transform in mm.")
    away = mesh.tree.nearest(transforms.apply(matrix, thinned(trace, LEAST_POINTS))).distances
    middle = float(np.median(away))
    if middle > FAR_OFF_MM:
        raise InputError(
            f"The start puts the trace {middle:.0f} mm off the head; touch the three landmarks "
            f"again, so that it lies within {FAR_OFF_MM:.0f} mm."
        )
    return matrix


def thinned(trace: np.ndarray, most: int = MOST_USED) -> np.ndarray:
    """Return at most `count` points of a trace, evenly spaced."""
    if len(trace) <= most:
        return trace
    return trace[np.linspace(0, len(trace) - 1, most).round().astype(int)]


def find_match_warnings(match: SurfaceMatch) -> Iterator[RegistrationWarning]:
    """Yield what looks wrong with a match.

    The codes are `slides`, `several-minima`, `not-converged`, `few-inliers`, `far-points` and
    `poor-fit`.
    """
    slide = match.slide
    if slide.distance_mm > SLIDE_LIMIT_MM:
        message = (
            f"The match may slide: targets in the brain may be off by up to "
            f"{slide.distance_mm:.1f} mm {slide.way}, and the {slide.place} of the head most, "
            "however small residual and interval are; trace places that face other ways, such "
            "as nose, brows, temples and cheeks."
        )
        yield RegistrationWarning("slides", (), message)
    if match.rivals or match.best_starts < LEAST_BEST_SHARE * match.starts:
        message = (
            f"Only {match.best_starts} of {match.starts} starts ended in this match; "
            f"others ended up to {match.spread_mm:.1f} mm away at the head's center: "
            "check the three landmarks, and trace more of the face."
        )
        yield RegistrationWarning("several-minima", (), message)
    if not match.converged:
        message = "The match had not settled when it was stopped."
        yield RegistrationWarning("not-converged", (), message)
    off = np.flatnonzero(~match.is_inlier & (match.residuals_mm > FAR_POINT_MM))
    names = tuple(str(row + 1) for row in off)
    if match.inlier_share < LEAST_INLIER_SHARE:
        message = (
            f"Only {match.inlier_share:.0%} of the points lie on the surface; keep the tip "
            "on the skin while you draw."
        )
        yield RegistrationWarning("few-inliers", names, message)
    elif len(off):
        those = f"{len(off)} points lie" if len(off) > 1 else f"Point {names[0]} lies"
        message = (
            f"{those} up to {match.residuals_mm[off].max():.1f} mm off the surface and "
            f"{'do' if len(off) > 1 else 'does'} not count."
        )
        yield RegistrationWarning("far-points", names, message)
    if match.rms_mm > POOR_RMS_MM:
        message = (
            f"The trace does not fit this head (residual {match.rms_mm:.1f} mm); check that "
            "head and images are of the same person and that the landmarks were not exchanged."
        )
        yield RegistrationWarning("poor-fit", (), message)


LEAST_NOISE_MM, ALIKE_MM = 1.0, 20.0
"""Standard deviation of what all points within a cube of so many mm are off alike, as skin is
pressed and drawn along. Residuals do not show it, and more points in one place do not reduce it."""
TARGETS_ASIDE_MM = 30.0
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
        return _DIRECTIONS[int(np.abs(self.direction).argmax())]


def places_around(target: np.ndarray) -> np.ndarray:
    """Return a target (3,) and places 30 mm around it, (7, 3) float, RAS mm.

    At the target alone, a head that turns about it would seem well known.
    """
    steps = TARGETS_ASIDE_MM * np.vstack([np.zeros(3), np.eye(3), -np.eye(3)])
    return np.asarray(target, dtype=float) + steps


def pose_rows(places: np.ndarray, normals: np.ndarray, center: np.ndarray) -> np.ndarray:
    """Return what points reveal about a pose that turns about a center: J (n, 6)."""
    return np.concatenate([normals, np.cross(places - center, normals)], axis=1)


def slide_of(
    places: np.ndarray, normals: np.ndarray, rms_mm: float, mesh: HeadMesh
) -> SurfaceSlide:
    """Return how far a head may slide under points that its surface fits.

    The curvature of the cost is H = Σ wᵢ JᵢᵀJᵢ with J = (n, (p − c) × n); σ²H⁻¹ is the covariance
    of the pose. All points within a cube of 20 mm count as one, w = 1/their number, as their errors
    are alike. The covariance is propagated to the middle of the head and six places around it. The
    largest eigenvalue among them, as a 95 % limit, is the answer; it ends at 100 mm.

    The places (n, 3), RAS mm, are where the match puts the points, and the normals (n, 3) the
    directions in which their distances grow. σ is `rms_mm`, at least 1 mm.
    """
    noise = max(rms_mm, LEAST_NOISE_MM)
    center = places.mean(axis=0)
    rows = pose_rows(places, normals, center)
    half = mesh.size / 2.0
    prior = (noise / _LOOSEST_MM) ** 2 * np.diag([1.0] * 3 + [float(half.max()) ** 2] * 3)
    cubes = np.floor(places / ALIKE_MM).astype(int)
    _, which, counts = np.unique(cubes, axis=0, return_inverse=True, return_counts=True)
    weighted = rows * np.asarray(1.0 / counts[which.reshape(-1)])[:, None]
    covariance = noise**2 * np.linalg.inv(weighted.T @ rows + prior)
    variance, direction = max(
        (_largest_move(covariance, place - center) for place in places_around(mesh.middle)),
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


def _largest_move(covariance: np.ndarray, arm: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the largest variance, mm², and its direction, at an arm (3,) from the center."""
    moves = motions(RIGID, arm[None])[0]
    values, vectors = np.linalg.eigh(moves @ covariance @ moves.T)
    return float(values[-1]), vectors[:, -1]
