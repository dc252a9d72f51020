"""The fit of points to a surface from several starts, by the true nearest points, trimmed.

The sum of the squared distances to the nearest points on the triangles is minimized by the method
of Gauss and Newton. A distance grows along the line to its nearest point, so each step is a step of
point-to-plane ICP (Chen and Medioni 1992), with that line as the plane's normal. Near the end, the
curvature is exact: a nearest point on an edge or a corner differs from one within a triangle. Where
a step leads up, since other triangles are nearest there, it is shortened to the minimum of the
parabola through both costs and the slope. Points far outside of the spread of all are left out
(trimmed ICP, Chetverikov 2002).

A head made of triangles has many minima close together. Where another triangle becomes the nearest
of some point, the cost has a kink, and on each side of it there may be a minimum; they lie some
hundredths of a millimeter apart, and their costs differ by thousandths of a percent. So a fit is
repeated from many places about as far off as the pose is uncertain, and the lowest is taken.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np
from numpy.random import default_rng

from rastrainer import transforms
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.triangle_tree import FollowedPoints, NearestPoints

STEP_MM = 10.0
"""No step moves a point of the trace farther: the nearest points are others there."""
_DAMPING = 1e-7
"""Damping, as a share of the Hessian's trace: limits steps along directions that the points do not
constrain."""


@dataclass(frozen=True)
class SurfaceFit:
    """Where each of s starts ended, with n points.

    Attributes:
        matrices: (s, 4, 4) float, World→RAS, mm.
        distances_mm: (s, n) float, to the surface.
        nearest_mm: (s, n, 3) float, RAS, the nearest points.
        triangles: (s, n) int, which they lie on.
        converged: (s,) bool.
    """

    matrices: np.ndarray
    distances_mm: np.ndarray
    nearest_mm: np.ndarray
    triangles: np.ndarray
    converged: np.ndarray

    def taken(self, rows: np.ndarray) -> SurfaceFit:
        """Return the fit of some of the starts."""
        return SurfaceFit(*(getattr(self, field.name)[rows] for field in fields(self)))

    def joined(self, other: SurfaceFit) -> SurfaceFit:
        """Return these fits and others of the same points."""
        pairs = ((getattr(one, field.name) for one in (self, other)) for field in fields(self))
        return SurfaceFit(*(np.concatenate(list(pair)) for pair in pairs))


def plane_normals(
    mesh: HeadMesh, offsets: np.ndarray, distances: np.ndarray, triangles: np.ndarray
) -> np.ndarray:
    """Return the unit directions (…, 3) in which the distances grow.

    It is the line from the nearest point; for a point on the surface, the triangle's normal.
    `offsets` (…, 3), mm, lead to the points from their nearest points, which lie on `triangles` (…)
    int.
    """
    normals = offsets / np.where(distances > 0.0, distances, 1.0)[..., None]
    close = np.nonzero(distances < 1e-6)
    if len(close[0]):
        normals[close] = mesh.triangle_normals[triangles[close]]
    return normals


def take_step(
    points: np.ndarray,
    mesh: HeadMesh,
    here: SurfaceFit,
    gate: np.ndarray,
    is_near: np.ndarray,
    share: np.ndarray,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Take a share (s,) of the steps of Gauss and Newton; near their ends (s,) bool, of Newton.

    Return matrices, the points' places, the longest move (s,), mm, and by how much the cost changes
    along the whole step, to first order, (s,), mm².
    """
    places = transforms.apply_each(here.matrices, points)
    center = places.mean(axis=1)
    arms = places - center[:, None]
    # Rotations are counted in mm at the trace's own extent, so that all parameters are alike.
    extent = np.sqrt(np.mean(np.sum(arms**2, axis=2), axis=1))
    offsets = places - here.nearest_mm
    normals = plane_normals(mesh, offsets, here.distances_mm, here.triangles)
    rows = np.concatenate(
        [normals, transforms.cross_products(arms, normals) / extent[:, None, None]], axis=2
    )
    weighted = rows * (here.distances_mm <= gate[:, None])[..., None]
    hessian = np.swapaxes(weighted, 1, 2) @ rows
    if is_near.any():
        gate = np.where(is_near, gate, -1.0)
        _add_bends(hessian, mesh, here, normals, arms, extent, gate)
    gradient = np.einsum("sni,sn->si", weighted, here.distances_mm)
    scale = np.trace(hessian, axis1=1, axis2=2) * _DAMPING + 1e-12
    whole = -np.linalg.solve(hessian + scale[:, None, None] * np.eye(6), gradient[..., None])
    whole = whole[..., 0]
    reach = np.linalg.norm(whole[:, :3], axis=1) + np.linalg.norm(whole[:, 3:], axis=1)
    whole *= np.minimum(1.0, STEP_MM / np.maximum(reach, 1e-12))[:, None]
    slope = 2.0 * np.einsum("si,si->s", gradient, whole)
    turn = transforms.rotations(share[:, None] * (whole[:, 3:] / extent[:, None]))
    moved = np.zeros_like(here.matrices)
    moved[:, :3, :3] = turn @ here.matrices[:, :3, :3]
    from_center = here.matrices[:, :3, 3] - center
    moved[:, :3, 3] = (turn @ from_center[..., None])[..., 0] + center
    moved[:, :3, 3] += share[:, None] * whole[:, :3]
    moved[:, 3, 3] = 1.0
    there = transforms.apply_each(moved, points)
    moves = there - places
    return moved, there, np.sqrt(np.einsum("sni,sni->sn", moves, moves).max(axis=1)), slope


def _add_bends(
    hessian: np.ndarray,
    mesh: HeadMesh,
    here: SurfaceFit,
    normals: np.ndarray,
    arms: np.ndarray,
    extent: np.ndarray,
    gate: np.ndarray,
) -> None:
    """Add to the curvature (s, 6, 6) of points within gates (s,) what edges and corners add.

    The squared distance to a plane bends along its normal alone, that to an edge also across the
    edge, and that to a corner in all directions.
    """
    own = np.abs(np.einsum("sni,sni->sn", normals, mesh.triangle_normals[here.triangles]))
    which, point = np.nonzero((own < 1.0 - 1e-7) & (here.distances_mm <= gate[:, None]))
    if not len(which):
        return
    corners = mesh.vertices[mesh.triangles[here.triangles[which, point]]]
    along = np.roll(corners, -1, axis=1) - corners
    along /= np.maximum(np.linalg.norm(along, axis=2, keepdims=True), 1e-12)
    off = here.nearest_mm[which, point][:, None] - corners
    is_on = np.linalg.norm(np.cross(off, along), axis=2) < 1e-6
    normal = normals[which, point]
    edge = along[np.arange(len(which)), is_on.argmax(axis=1)]
    across = np.cross(edge, normal)
    across /= np.maximum(np.linalg.norm(across, axis=1, keepdims=True), 1e-12)
    across *= is_on.any(axis=1)[:, None]
    is_corner = is_on.sum(axis=1) > 1
    third = np.cross(normal, across) * is_corner[:, None]
    for direction in (across, third):
        turning = transforms.cross_products(arms[which, point], direction) / extent[which][:, None]
        rows = np.concatenate([direction, turning], axis=1)
        np.add.at(hessian, which, rows[:, :, None] * rows[:, None, :])


MAX_ITERATIONS = 60
FOLLOWED_MM = 1.0
"""After a step that moves no point farther, the triangles nearby are kept for the next steps."""
BENT_MM = 0.5
"""After a step that moves no point farther, edges and corners bend the cost: earlier, they would
keep points from sliding past; without them, the steps would not end."""
AROUND, AROUND_MM = 1.1, 0.05
"""Factor and margin on the starts' distance from their middle: triangles within that reach are
kept."""
GATE = 3.5
"""A point counts up to this many standard deviations, estimated from the median distance."""
LEAST_GATE_MM = 1.0
GATE_STEPS = 10
"""After this many steps, the gate only narrows: otherwise a point at the gate could be left out and
counted again forever."""
_NORMAL_PER_MEDIAN = 1.4826
_LEAST_SHARE = 1e-4
"""A step is shortened no further: the nearest points change on the spot."""
_SHORTENED = 0.1, 0.6
"""Least and largest share of the last step."""
NEARBY = 24
"""Starts; of the heads that were compared, the lowest minimum draws one in ten or more."""
NEARBY_SD = 0.25, 1.0
"""How far off every other is, in standard deviations of the pose, estimated from the residuals."""
NEARBY_MM = 2.0
"""How far off at most, along each axis of the pose."""
NEARBY_STEPS, FOLLOWED = 2, 8
"""After this many steps, only this many of the starts are followed to their ends."""


def gates(distances: np.ndarray) -> np.ndarray:
    """Return the distance up to which points count, (s,) float, mm, for distances (s, n)."""
    spread = _NORMAL_PER_MEDIAN * np.median(distances, axis=1)
    return np.maximum(LEAST_GATE_MM, GATE * spread)


def costs(distances: np.ndarray, gate: np.ndarray | float) -> np.ndarray:
    """Return Σ min(d, gate)², (s,) float, mm², for distances (s, n) and gates (s,) or one."""
    return np.asarray(np.sum(np.minimum(distances, np.reshape(gate, (-1, 1))) ** 2, axis=1))


def fit_to_surface(
    points: np.ndarray,
    mesh: HeadMesh,
    starts: np.ndarray,
    tolerance_mm: float,
    *,
    gate_mm: float | None = None,
    max_iterations: int = MAX_ITERATIONS,
    around: np.ndarray | None = None,
) -> SurfaceFit:
    """Fit points to a surface from each of several starts.

    Args:
        points: (n, 3) float, World mm.
        starts: (s, 4, 4) float, rigid, World→RAS.
        tolerance_mm: A start has converged when its next whole step would move no point farther.
        gate_mm: Up to which distance points count; infinite, all count; None: by their spread.
        around: (4, 4) float, a matrix near all starts; the surface is searched there once for all.
    """
    count = len(points)
    followed = _followed(points, mesh, starts, around)
    now = _placed(starts, followed.nearest)
    share = np.ones(len(starts))
    limit = np.full(len(starts), np.inf if gate_mm is None else gate_mm)
    last = np.full(len(starts), np.inf if around is None else 0.0)
    active = np.arange(len(starts))
    for number in range(max_iterations):
        here = now.taken(active)
        if gate_mm is None:
            widest = np.inf if number < GATE_STEPS else limit[active]
            limit[active] = np.minimum(gates(here.distances_mm), widest)
        gate = limit[active]
        near = last[active] < BENT_MM
        moved, places, longest, slope = take_step(points, mesh, here, gate, near, share[active])
        # After a small step, all that follow are hardly longer together; after a long one, far more
        # triangles would have to be kept than are found anew.
        slack = np.where(longest < FOLLOWED_MM, longest, 0.0)
        next_ = _placed(moved, followed.move(places.reshape(-1, 3), np.repeat(slack, count)))
        last[active] = longest
        before, after = costs(here.distances_mm, gate), costs(next_.distances_mm, gate)
        better = after <= before
        # `longest` belongs to a share of the whole step.
        done = (longest < tolerance_mm * share[active]) | (share[active] < _LEAST_SHARE)
        share[active] = _next_share(share[active], before, after, slope * share[active])
        for name in ("matrices", "distances_mm", "nearest_mm", "triangles"):
            getattr(now, name)[active[better]] = getattr(next_, name)[better]
        now.converged[active[done]] = True
        active = active[~done]
        if not len(active):
            break
        if done.any():
            rows = np.arange(len(done) * count).reshape(-1, count)
            followed.keep(rows[~done].ravel())
    return now


def _followed(
    points: np.ndarray, mesh: HeadMesh, starts: np.ndarray, around: np.ndarray | None
) -> FollowedPoints:
    places = transforms.apply_each(starts, points)
    if around is None:
        return FollowedPoints(mesh.tree, places.reshape(-1, 3), 0.0)
    middle = transforms.apply_each(around[None], points)[0]
    slack = AROUND * np.linalg.norm(places - middle, axis=2) + AROUND_MM
    followed = FollowedPoints(mesh.tree, middle, slack.max(axis=0))
    followed.repeat(slack)
    followed.move(places.reshape(-1, 3), slack.ravel())
    return followed


def _placed(matrices: np.ndarray, nearest: NearestPoints) -> SurfaceFit:
    size = len(matrices)
    return SurfaceFit(
        np.array(matrices, dtype=float),
        nearest.distances.reshape(size, -1),
        nearest.positions.reshape(size, -1, 3),
        nearest.triangles.reshape(size, -1),
        np.zeros(size, dtype=bool),
    )


def _next_share(
    share: np.ndarray, before: np.ndarray, after: np.ndarray, change: np.ndarray
) -> np.ndarray:
    """Return which shares (s,) of the next steps to take, by costs and the predicted change."""
    lowest = -change / np.maximum(2.0 * (after - before - change), 1e-30)
    shorter = share * np.clip(lowest, *_SHORTENED)
    return np.where(after <= before, np.minimum(1.0, 2.0 * share), shorter)


def lowest_nearby(
    points: np.ndarray,
    mesh: HeadMesh,
    fit: SurfaceFit,
    tolerance_mm: float,
    gate_mm: float,
    seed: int,
) -> SurfaceFit:
    """Return the lowest minimum found next to a fit of one start, as a fit of one start.

    The seed draws the places from which the fit is repeated.
    """
    begun = np.concatenate([fit.matrices, _moved(points, mesh, fit, gate_mm, seed)])
    first = fit_to_surface(
        points,
        mesh,
        begun,
        tolerance_mm,
        gate_mm=gate_mm,
        max_iterations=NEARBY_STEPS,
        around=fit.matrices[0],
    )
    order = costs(first.distances_mm, gate_mm).argsort(kind="stable")[:FOLLOWED]
    begun = first.matrices[order]
    ended = fit_to_surface(points, mesh, begun, tolerance_mm, gate_mm=gate_mm, around=begun[0])
    lowest = costs(ended.distances_mm, gate_mm).argmin()
    return ended.taken(np.array([lowest]))


def _moved(
    points: np.ndarray, mesh: HeadMesh, fit: SurfaceFit, gate_mm: float, seed: int
) -> np.ndarray:
    """Return matrices (NEARBY, 4, 4) about a fit's matrix, drawn by the covariance of its pose."""
    counts = fit.distances_mm[0] <= gate_mm
    places = transforms.apply_each(fit.matrices, points)[0]
    center = places.mean(axis=0)
    extent = float(np.sqrt(np.mean(np.sum((places - center) ** 2, axis=1))))
    offsets, distances = places - fit.nearest_mm[0], fit.distances_mm[0]
    normals = plane_normals(mesh, offsets, distances, fit.triangles[0])[counts]
    rows = np.concatenate([normals, np.cross(places[counts] - center, normals) / extent], axis=1)
    curvature, axes = np.linalg.eigh(rows.T @ rows)
    variance = np.mean(distances[counts] ** 2) / np.maximum(curvature, 1e-9)
    sizes = np.minimum(np.resize(NEARBY_SD, (NEARBY, 1)) * np.sqrt(variance), NEARBY_MM)
    steps = (default_rng([seed, 1]).normal(size=(NEARBY, 6)) * sizes) @ axes.T
    moved = np.tile(np.eye(4), (NEARBY, 1, 1))
    moved[:, :3, :3] = transforms.rotations(steps[:, 3:] / extent)
    moved[:, :3, 3] = center - moved[:, :3, :3] @ center + steps[:, :3]
    return np.asarray(moved @ fit.matrices[0])
