"""The fit of points to a surface from several starts, by the true nearest points, trimmed.

The sum of the squared distances to the nearest points on the triangles is minimized by the method
of Levenberg and Marquardt. A distance grows along the line to its nearest point, so each step is
that of point-to-plane ICP (Chen and Medioni 1992), with that line as the plane's normal. Points far
outside of the spread of all are left out anew in each step (trimmed ICP, Chetverikov 2002).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer.head.mesh import HeadMesh

MAX_ITERATIONS = 60
STEP_MM = 10.0
"""No step moves a point of the trace farther: the nearest points are others there."""
GATE = 3.5
"""A point counts up to this many standard deviations, estimated from the median distance."""
LEAST_GATE_MM = 1.0
_NORMAL_PER_MEDIAN = 1.4826
_DAMPING = 1e-7
_MOST_DAMPING = 1e4


@dataclass(frozen=True)
class SurfaceFit:
    """Where each of s starts ended, with n points.

    Attributes:
        matrices: (s, 4, 4) float, World→RAS, mm.
        distances_mm: (s, n) float, to the surface.
        nearest_mm: (s, n, 3) float, RAS, the nearest points.
        triangles: (s, n) int, which they lie on.
        converged: (s,) bool.
        iterations: (s,) int.
    """

    matrices: np.ndarray
    distances_mm: np.ndarray
    nearest_mm: np.ndarray
    triangles: np.ndarray
    converged: np.ndarray
    iterations: np.ndarray

    def taken(self, rows: np.ndarray) -> SurfaceFit:
        """Return the fit of some of the starts."""
        return SurfaceFit(
            self.matrices[rows],
            self.distances_mm[rows],
            self.nearest_mm[rows],
            self.triangles[rows],
            self.converged[rows],
            self.iterations[rows],
        )


def gates(distances: np.ndarray, trimmed: bool = True) -> np.ndarray:
    """Return up to which distance points count, (s,) float, mm, for distances (s, n)."""
    if not trimmed:
        return np.full(len(distances), np.inf)
    spread = _NORMAL_PER_MEDIAN * np.median(distances, axis=1)
    return np.maximum(LEAST_GATE_MM, GATE * spread)


def costs(distances: np.ndarray, gate: np.ndarray) -> np.ndarray:
    """Return Σ min(d, gate)², (s,) float, mm², for distances (s, n) and gates (s,)."""
    return np.sum(np.minimum(distances, gate[:, None]) ** 2, axis=1)


def fit_to_surface(
    points: np.ndarray,
    mesh: HeadMesh,
    starts: np.ndarray,
    tolerance_mm: float,
    *,
    trimmed: bool = True,
    max_iterations: int = MAX_ITERATIONS,
) -> SurfaceFit:
    """Fit points to a surface from each of several starts.

    Args:
        points: (n, 3) float, World mm.
        mesh: The surface, RAS mm.
        starts: (s, 4, 4) float, rigid, World→RAS.
        tolerance_mm: A start has converged when a step moves no point farther.
        trimmed: Whether points far outside of the spread are left out.
        max_iterations: For each start.
    """
    now = _placed(points, mesh, starts, None)
    size = len(starts)
    converged, iterations = np.zeros(size, dtype=bool), np.zeros(size, dtype=int)
    damping = np.full(size, _DAMPING)
    active = np.arange(size)
    for _ in range(max_iterations):
        if not len(active):
            break
        here = now.taken(active)
        gate = gates(here.distances_mm, trimmed)
        moved = _stepped(points, mesh, here, gate, damping[active])
        next_ = _placed(points, mesh, moved, here.triangles)
        iterations[active] += 1
        better = costs(next_.distances_mm, gate) <= costs(here.distances_mm, gate)
        longest = _longest_move(points, here.matrices, moved)
        damping[active] = np.where(
            better, np.maximum(damping[active] / 10.0, _DAMPING), damping[active] * 100.0
        )
        _replace(now, active[better], next_.taken(np.flatnonzero(better)))
        done = (longest < tolerance_mm) | (damping[active] > _MOST_DAMPING)
        converged[active[done]] = True
        active = active[~done]
    return SurfaceFit(
        now.matrices, now.distances_mm, now.nearest_mm, now.triangles, converged, iterations
    )


def plane_normals(mesh: HeadMesh, fit: SurfaceFit, points: np.ndarray) -> np.ndarray:
    """Return the unit directions (s, n, 3) in which the distances grow.

    It is the line from the nearest point; for a point on the surface, the triangle's normal.
    """
    offsets = transforms_of(fit.matrices, points) - fit.nearest_mm
    distances = fit.distances_mm[..., None]
    normals = offsets / np.where(distances > 0.0, distances, 1.0)
    close = np.nonzero(fit.distances_mm < 1e-6)
    if len(close[0]):
        corners = mesh.vertices[mesh.triangles[fit.triangles[close]]]
        across = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        lengths = np.linalg.norm(across, axis=1, keepdims=True)
        normals[close] = across / np.where(lengths > 0.0, lengths, 1.0)
    return normals


def transforms_of(matrices: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Return points (n, 3) mapped by each of the matrices (s, 4, 4), (s, n, 3) float."""
    return points @ np.swapaxes(matrices[:, :3, :3], 1, 2) + matrices[:, None, :3, 3]


def rotations(vectors: np.ndarray) -> np.ndarray:
    """Return the rotations (s, 3, 3) about vectors (s, 3) by their lengths in rad (Rodrigues)."""
    angles = np.linalg.norm(vectors, axis=1)
    cross = np.cross(vectors[:, None, :], np.eye(3))
    safe = np.where(angles > 1e-12, angles, 1.0)
    first = np.where(angles > 1e-12, np.sin(safe) / safe, 1.0)
    second = np.where(angles > 1e-12, (1.0 - np.cos(safe)) / safe**2, 0.5)
    # np.cross(v, e) has the columns of [v]× as its rows.
    cross = np.swapaxes(cross, 1, 2)
    return np.eye(3) + first[:, None, None] * cross + second[:, None, None] * cross @ cross


def _placed(
    points: np.ndarray, mesh: HeadMesh, matrices: np.ndarray, guess: np.ndarray | None
) -> SurfaceFit:
    places = transforms_of(matrices, points)
    nearest = mesh.tree.nearest(places.reshape(-1, 3), None if guess is None else guess.ravel())
    shape = places.shape[:2]
    return SurfaceFit(
        np.array(matrices, dtype=float),
        nearest.distances.reshape(shape),
        nearest.positions.reshape(*shape, 3),
        nearest.triangles.reshape(shape),
        np.zeros(len(matrices), dtype=bool),
        np.zeros(len(matrices), dtype=int),
    )


def _replace(now: SurfaceFit, rows: np.ndarray, other: SurfaceFit) -> None:
    now.matrices[rows] = other.matrices
    now.distances_mm[rows] = other.distances_mm
    now.nearest_mm[rows] = other.nearest_mm
    now.triangles[rows] = other.triangles


def _stepped(
    points: np.ndarray, mesh: HeadMesh, here: SurfaceFit, gate: np.ndarray, damping: np.ndarray
) -> np.ndarray:
    """Return the matrices (s, 4, 4) after one step of Levenberg and Marquardt."""
    places = transforms_of(here.matrices, points)
    center = places.mean(axis=1)
    arms = places - center[:, None]
    # Rotations are counted in mm at the trace's own extent, so that all parameters are alike.
    extent = np.sqrt(np.mean(np.sum(arms**2, axis=2), axis=1))
    normals = plane_normals(mesh, here, points)
    rows = np.concatenate([normals, np.cross(arms, normals) / extent[:, None, None]], axis=2)
    weights = (here.distances_mm <= gate[:, None]).astype(float)[..., None]
    hessian = np.swapaxes(rows * weights, 1, 2) @ rows
    gradient = np.einsum("sni,sn->si", rows * weights, here.distances_mm)
    scale = np.trace(hessian, axis1=1, axis2=2) * damping + 1e-12
    hessian = hessian + scale[:, None, None] * np.eye(6)
    step = -np.linalg.solve(hessian, gradient[..., None])[..., 0]
    reach = np.linalg.norm(step[:, :3], axis=1) + np.linalg.norm(step[:, 3:], axis=1)
    step *= np.minimum(1.0, STEP_MM / np.maximum(reach, 1e-12))[:, None]
    turn = rotations(step[:, 3:] / extent[:, None])
    moved = np.zeros_like(here.matrices)
    moved[:, :3, :3] = turn @ here.matrices[:, :3, :3]
    from_center = here.matrices[:, :3, 3] - center
    moved[:, :3, 3] = (turn @ from_center[..., None])[..., 0] + center + step[:, :3]
    moved[:, 3, 3] = 1.0
    return moved


def _longest_move(points: np.ndarray, before: np.ndarray, after: np.ndarray) -> np.ndarray:
    moves = transforms_of(after, points) - transforms_of(before, points)
    return np.linalg.norm(moves, axis=2).max(axis=1)
