"""The target error to expect of a surface match, and where on the skin more points would help most.

The curvature of the cost at its minimum is H = Σ JᵢᵀJᵢ with Jᵢ = (nᵢ, (pᵢ − c) × nᵢ): what each
point reveals about the pose. σ²H⁻¹ is the covariance of the pose, with the variance σ² of the
points across the skin. Both are to first order, and for errors that are independent: a shift of the
skin is not. It guides a trainee who traces the skin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.errors import InputError
from rastrainer.head.mesh import POINTS_AT_ONCE, HeadMesh, nearest_vertices
from rastrainer.protocol import MAX_TRACE_POINTS
from rastrainer.registration.fits import PARAMETERS, RIGID, motions
from rastrainer.registration.surface_checks import SurfaceMatch, places_around, pose_rows
from rastrainer.registration.target_error import COMMON_BIAS_SD_MM, TargetError, error_of_covariance

UNKNOWN_MM, UNKNOWN_RAD = 10.0, 0.2
"""Standard deviations of a pose before the first point, on each axis: what landmarks leave open."""
USUAL_NOISE_MM = 0.5
DAB = 10
"""Points that are drawn at the next place: one centimeter of path."""


@dataclass(frozen=True, eq=False)
class PoseKnowledge:
    """The information of points on the skin about the head's pose.

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

    def at_targets(self, targets: np.ndarray) -> np.ndarray:
        """Return the covariances (m, 3, 3), mm², of the error at targets (m, 3), RAS mm."""
        moved = motions(RIGID, targets - self.center)
        covariance = self.noise_mm**2 * np.linalg.inv(self.curvature)
        return moved @ covariance @ np.swapaxes(moved, 1, 2)


def knowledge_of(match: SurfaceMatch) -> PoseKnowledge:
    """Return what a match reveals about the pose: from its points that count, and their residuals.

    σ² is Σ r²/(n − 6): the fit takes six parameters from the residuals.
    """
    places = match.places_mm[match.is_inlier]
    center = places.mean(axis=0)
    rows = pose_rows(places, match.normals[match.is_inlier], center)
    curvature = rows.T @ rows
    if np.linalg.cond(curvature) > 1e12:
        raise InputError(
            "The trace leaves the head free to turn or slide; trace places that face other ways."
        )
    squares = float(np.sum(match.residuals_mm[match.is_inlier] ** 2))
    dof = len(places) - PARAMETERS[RIGID]
    return PoseKnowledge(center, curvature, float(np.sqrt(squares / dof)), dof)


def knowledge_so_far(
    places: np.ndarray, normals: np.ndarray, mesh: HeadMesh, noise_mm: float = USUAL_NOISE_MM
) -> PoseKnowledge:
    """Return what the points of an unfinished trace reveal, however few; nothing without points.

    Before the first point, a pose is known to 10 mm and 0.2 rad on each axis. The places (n, 3),
    RAS mm, are where the points lie by the pose known so far, with the unit normals (n, 3) of the
    skin there; σ is assumed.
    """
    rows = pose_rows(np.reshape(places, (-1, 3)), np.reshape(normals, (-1, 3)), mesh.middle)
    known = np.diag([(noise_mm / UNKNOWN_MM) ** 2] * 3 + [(noise_mm / UNKNOWN_RAD) ** 2] * 3)
    return PoseKnowledge(mesh.middle, rows.T @ rows + known, noise_mm, np.inf)


def surface_target_error(
    knowledge: PoseKnowledge, target: np.ndarray, common_bias_sd_mm: float = COMMON_BIAS_SD_MM
) -> TargetError:
    """Return the error to expect at a target (3,), RAS mm, with its interval.

    An offset that all points share, such as a wrong calibration of the tip, moves the whole head
    and adds 3σ² of its standard deviation on each axis, as with fiducials. The interval also
    follows `rastrainer.registration.target_error.target_error`, and has the same blind spots:
    errors that neighboring points share. It holds less often for drawn traces; see
    Testing/error_rates/tables.md.
    """
    return error_of_covariance(
        target,
        knowledge.at_targets(np.reshape(target, (1, 3)))[0],
        fle_mm=knowledge.noise_mm,
        degrees_of_freedom=knowledge.degrees_of_freedom,
        common_bias_sd_mm=common_bias_sd_mm,
    )


@dataclass(frozen=True)
class NextPlace:
    """Where on the skin more points would help most, RAS mm, with its outward unit normal there."""

    vertex: int
    position: np.ndarray
    normal: np.ndarray


def next_best_place(
    knowledge: PoseKnowledge, mesh: HeadMesh, targets: np.ndarray, allowed: np.ndarray
) -> NextPlace:
    """Return the place whose points would reduce the expected TRE at targets (m, 3), RAS mm, most.

    k points at a place with the row J change the covariance C = H⁻¹ by −k·CJᵀJC/(1 + k·JCJᵀ)
    (Sherman and Morrison 1950), so all places are compared at once: the vertices (v,) bool that can
    be reached, at least one.
    """
    rows = np.flatnonzero(allowed)
    if not len(rows):
        raise InputError("No place on the skin can be reached.")
    moved = motions(RIGID, np.asarray(targets, dtype=float) - knowledge.center)
    weight = np.einsum("tij,tik->jk", moved, moved) / len(moved)
    inverse = np.linalg.inv(knowledge.curvature)
    directions = pose_rows(mesh.vertices[rows], mesh.vertex_normals[rows], knowledge.center)
    turned = directions @ inverse
    gain = DAB * np.einsum("vi,ij,vj->v", turned, weight, turned)
    gain /= 1.0 + DAB * np.einsum("vi,vi->v", turned, directions)
    best = int(rows[gain.argmax()])
    return NextPlace(best, mesh.vertices[best], mesh.vertex_normals[best])


COVERED_MM = 10.0
"""Within this distance of a traced point the skin is covered: no next place lies there."""
SPACING_MM = 8.0
"""Distance between compared places; a finer grid would hardly change the best one."""
ABOVE_BASE_MM = 10.0
LEAST_UPWARD = -0.3
"""Least height of a unit normal: the tool does not reach skin that faces the table."""
LEAST_FACING = 0.5
"""Least cosine between a normal and the line to the eye: little is seen of other skin."""
LEAST_OUTWARD = 0.5
"""Least cosine between a normal and the line from the head's middle: it is less at ears, which give
way, and at nostrils."""
LEAST_FLATNESS = 0.95
"""Least length of the mean of unit normals around a place: lids, lips and folds bend more."""
BEHIND_MM = 30.0
"""Places this much nearer to the eye hide a place next to them."""
_ROUNDS = 4
_BESIDE_MM = 6.0


def guided_vertices(mesh: HeadMesh, eye: np.ndarray) -> np.ndarray:
    """Return the vertices among which the next place is chosen, (c,) int, 8 mm apart.

    They are seen by the trainee's eye (3,), RAS mm, do not face the table, and are off the base and
    the ears, where the skin is smooth. The head is upright.
    """
    normals, vertices = mesh.vertex_normals, mesh.vertices
    toward, outward = _directions(vertices, eye), -_directions(vertices, mesh.middle)
    usable = (
        (vertices[:, 2] > vertices[:, 2].min() + ABOVE_BASE_MM)
        & (normals[:, 2] > LEAST_UPWARD)
        & (np.einsum("ij,ij->i", normals, toward) > LEAST_FACING)
        & (np.einsum("ij,ij->i", normals, outward) > LEAST_OUTWARD)
        & (_flatness(mesh) > LEAST_FLATNESS)
        & _is_seen(vertices, eye)
    )
    rows = np.flatnonzero(usable)
    cells = np.floor(vertices[rows] / SPACING_MM).astype(int)
    return rows[np.sort(np.unique(cells, axis=0, return_index=True)[1])]


def nearest_traced_mm(
    vertices: np.ndarray, places: np.ndarray, known_mm: np.ndarray | None = None
) -> np.ndarray:
    """Return how far vertices (v, 3) are from the nearest point of a trace (n, 3), (v,) float.

    `known_mm` has the distances to the points before these, (v,) float; infinite without any.
    """
    found = np.full(len(vertices), np.inf) if known_mm is None else known_mm
    # Relative to the middle, so that subtracting squares loses few digits.
    middle = vertices.mean(axis=0)
    from_middle, places = vertices - middle, places - middle
    squares = np.einsum("ij,ij->i", from_middle, from_middle)
    for start in range(0, len(places), POINTS_AT_ONCE):
        some = places[start : start + POINTS_AT_ONCE]
        # |v − p|² = |v|² + (|p|² − 2 v·p): one product of matrices for all.
        rest = np.einsum("ij,ij->i", some, some) - 2.0 * from_middle @ some.T
        away = np.sqrt(np.maximum(squares + rest.min(axis=1), 0.0))
        found = np.minimum(found, away)
    return found


class TraceGuide:
    """Follows a trace, and finds where its next points would help most.

    A place stays until a centimeter has been drawn within `COVERED_MM` of it, or a stroke elsewhere
    has ended: nobody could follow a place that jumps about.

    Attributes:
        away_mm: (v,) float, from each vertex of the head to the trace; infinite without points.
    """

    def __init__(self, mesh: HeadMesh, target: np.ndarray, eye: np.ndarray) -> None:
        """Prepare guidance on a head, for a target and an eye, (3,) float, RAS mm."""
        self._mesh = mesh
        self._targets = places_around(target)
        self._vertices = guided_vertices(mesh, eye)
        self._places = np.zeros((0, 3))
        self._rows = np.zeros(0, dtype=int)
        self.away_mm = np.full(len(mesh.vertices), np.inf)
        self._told: NextPlace | None = None
        self._told_at = -1

    def next_place(self, places: np.ndarray, is_drawing: bool) -> NextPlace | None:
        """Return where to draw next; None if the trace is full or covers every place within reach.

        The places (n, 3), RAS mm, are all points so far by the pose that is known.
        """
        self._follow(places)
        if not self._is_kept(is_drawing):
            self._told, self._told_at = self._best(), len(places)
        return self._told

    def _follow(self, places: np.ndarray) -> None:
        """Take in the points that are new; after an undone stroke, all that are left."""
        known = len(self._places)
        if len(places) < known or not np.array_equal(places[:known], self._places):
            known, self._told_at = 0, -1
            self._rows, self.away_mm = self._rows[:0], np.full_like(self.away_mm, np.inf)
        new = places[known:]
        self._rows = np.concatenate([self._rows, nearest_vertices(self._mesh, new)[1]])
        self.away_mm = nearest_traced_mm(self._mesh.vertices, new, self.away_mm)
        self._places = places

    def _is_kept(self, is_drawing: bool) -> bool:
        """Return whether the last place found still has to be drawn."""
        if self._told_at == len(self._places):
            return True
        if self._told is None or self._told_at < 0 or not is_drawing:
            return False
        drawn = self._places[self._told_at :] - self._told.position
        return int(np.sum(np.linalg.norm(drawn, axis=1) <= COVERED_MM)) < DAB

    def _best(self) -> NextPlace | None:
        open_ = self._vertices[self.away_mm[self._vertices] > COVERED_MM]
        if len(self._places) >= MAX_TRACE_POINTS or not len(open_):
            return None
        allowed = np.zeros(len(self._mesh.vertices), dtype=bool)
        allowed[open_] = True
        normals = self._mesh.vertex_normals[self._rows]
        knowledge = knowledge_so_far(self._places, normals, self._mesh)
        return next_best_place(knowledge, self._mesh, self._targets, allowed)


def _directions(places: np.ndarray, goal: np.ndarray) -> np.ndarray:
    """Return unit vectors (n, 3) from places (n, 3) to a goal (3,)."""
    ways = goal - places
    lengths = np.linalg.norm(ways, axis=1, keepdims=True)
    return np.asarray(ways / np.where(lengths > 0.0, lengths, 1.0))


def _is_seen(vertices: np.ndarray, eye: np.ndarray) -> np.ndarray:
    """Return which vertices, (v,) bool, no others hide from an eye (3,), with a margin.

    Each is compared with those in its and the neighboring cells of a picture.
    """
    ways = vertices - eye
    ahead = vertices.mean(axis=0) - eye
    ahead = ahead / np.linalg.norm(ahead)
    across = np.cross(ahead, np.eye(3)[np.abs(ahead).argmin()])
    across /= np.linalg.norm(across)
    depth = ways @ ahead
    scale = depth.mean() / (_BESIDE_MM * depth)
    flat = scale[:, None] * (ways @ np.stack([across, np.cross(ahead, across)], axis=1))
    cells = np.floor(flat).astype(int)
    cells -= cells.min(axis=0) - 1
    nearest = np.full(cells.max(axis=0) + 2, np.inf)
    np.minimum.at(nearest, tuple(cells.T), depth)
    steps = [(right, up) for right in (-1, 0, 1) for up in (-1, 0, 1)]
    around = np.min([np.roll(nearest, step, axis=(0, 1)) for step in steps], axis=0)
    return depth - around[tuple(cells.T)] < BEHIND_MM


def _flatness(mesh: HeadMesh) -> np.ndarray:
    """Return the length of the mean normal around each vertex, (v,) float, 1 where it is flat."""
    first, second = mesh.edges.T
    count = len(mesh.vertices)
    neighbors = 1.0 + np.bincount(mesh.edges.ravel(), minlength=count)
    mean = mesh.vertex_normals
    for _ in range(_ROUNDS):
        sums = [
            of + np.bincount(first, of[second], count) + np.bincount(second, of[first], count)
            for of in mean.T
        ]
        mean = np.stack(sums, axis=1) / neighbors[:, None]
    return np.linalg.norm(mean, axis=1)
