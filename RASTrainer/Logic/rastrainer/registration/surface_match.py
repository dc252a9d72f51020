"""Registration of a trace over the skin (`World`) to the head's surface (MRI RAS), in mm."""

from __future__ import annotations

import numpy as np
from numpy.random import default_rng

from rastrainer import transforms
from rastrainer.head.mesh import HeadMesh
from rastrainer.registration import surface_checks, surface_fit

STARTS = 8
START_SD_MM, START_SD_DEG = 5.0, 5.0
"""Spread of the starts about the given start, on each axis: the uncertainty that three landmarks
leave."""
WIDER_STARTS, WIDER, NEAR_SKIN_MM = 16, 3.0, 1.0
"""More starts, several times as far off, if none brings half of the points near the skin."""
COARSE_POINTS, COARSE_ITERATIONS, MIDDLE_ITERATIONS = 40, 12, 30
COARSE_TOLERANCE_MM = 0.2
MIDDLE_TOLERANCE_MM, TOLERANCE_MM = 0.02, 1e-3
HOPELESS = 4.0
"""A minimum whose coarse cost is this many times the best one's is followed no further."""
RIVAL_COST = 2.0
OTHER_MINIMUM_MM = 2.0
"""A minimum this far away at the head's center, and at most twice as costly, is a rival."""
SAME_MINIMUM_MM = 0.5
"""Fits that differ by less at the head's center and at the trace are one minimum."""


def match_surface(
    trace_mm: np.ndarray,
    mesh: HeadMesh,
    start: np.ndarray,
    *,
    seed: int = 0,
    starts: int = STARTS,
    trimmed: bool = True,
) -> surface_checks.SurfaceMatch:
    """Fit a trace over the skin to the surface of a head.

    The first match with a mesh takes about half a second more, for its search tree.

    Args:
        trace_mm: (n, 3) float, World, 30 points or more, about one per millimeter of path; of more
            than 500 points, every so many-th is used for the fit.
        mesh: The head's closed surface, RAS.
        start: (4, 4) float, rigid, World→RAS, as from three landmarks: within about 10 mm and 10°.
        seed: Of the further starts about it.
        starts: Number of starts with the given one; a single start also skips the search for lower
            minima nearby.
        trimmed: Whether points far off are left out of the fit.
    """
    trace = surface_checks.check_trace(trace_mm)
    surface_checks.check_surface(mesh)
    skin = mesh.skin
    start = surface_checks.check_start(start, trace, skin)
    used = surface_checks.thinned(trace)
    fit, hopeless, ended, gate = _fit(used, skin, start, starts, trimmed, seed)
    return _match(trace, skin, fit, hopeless, ended, gate)


def difference_mm(one: np.ndarray, other: np.ndarray, mesh: HeadMesh, points: np.ndarray) -> float:
    """Return how far two matrices World→RAS lie apart at most, mm: at head's center and trace."""
    places = np.vstack([points, transforms.apply(transforms.inverse(one), mesh.middle)])
    apart = transforms.apply(one, places) - transforms.apply(other, places)
    return float(np.linalg.norm(apart, axis=1).max())


def _starts_about(
    start: np.ndarray, points: np.ndarray, count: int, seed: int, wider: float = 1.0
) -> np.ndarray:
    """Return the start and others about it, (count, 4, 4), turned about the trace's centroid."""
    random = default_rng(seed)
    shifts = random.normal(0.0, wider * START_SD_MM, (count, 3))
    turns = np.radians(random.normal(0.0, wider * START_SD_DEG, (count, 3)))
    shifts[0], turns[0] = 0.0, 0.0
    center = transforms.apply(start, points.mean(axis=0))
    turned = np.tile(np.eye(4), (count, 1, 1))
    turned[:, :3, :3] = transforms.rotations(turns)
    turned[:, :3, 3] = center + shifts - turned[:, :3, :3] @ center
    return turned @ start


def _coarse(
    points: np.ndarray, mesh: HeadMesh, start: np.ndarray, count: int, gate: float | None, seed: int
) -> surface_fit.SurfaceFit:
    """Return fits of some of the points from all starts, and from wider starts if none fits."""
    few = surface_checks.thinned(points, COARSE_POINTS)

    def fitted(starts: np.ndarray) -> surface_fit.SurfaceFit:
        return surface_fit.fit_to_surface(
            few, mesh, starts, COARSE_TOLERANCE_MM, gate_mm=gate, max_iterations=COARSE_ITERATIONS
        )

    fit = fitted(_starts_about(start, points, count, seed))
    if count == 1 or np.median(fit.distances_mm, axis=1).min() < NEAR_SKIN_MM:
        return fit
    return fit.joined(fitted(_starts_about(start, points, WIDER_STARTS, seed, WIDER)))


def _fit(
    points: np.ndarray, mesh: HeadMesh, start: np.ndarray, starts: int, trimmed: bool, seed: int
) -> tuple[surface_fit.SurfaceFit, np.ndarray, np.ndarray, float]:
    """Return the fits, best first; the matrices of hopeless fits; how many starts ended in each.

    The last is up to which distance points count. All starts are first followed with some of the
    points; those that meet continue as one, and the best of them also from many places next to it.
    """
    every = None if trimmed else np.inf
    coarse = _coarse(points, mesh, start, starts, every, seed)
    first, which = _minima(coarse, mesh, points, _common_gate(coarse, trimmed))
    score = surface_fit.costs(coarse.distances_mm, _common_gate(coarse, trimmed))[first]
    hopeful = first[score <= HOPELESS * score[0] + 1e-6]
    middle = surface_fit.fit_to_surface(
        points,
        mesh,
        coarse.matrices[hopeful],
        MIDDLE_TOLERANCE_MM,
        gate_mm=every,
        max_iterations=MIDDLE_ITERATIONS,
    )
    gate = _common_gate(middle, trimmed)
    lowest, again = _minima(middle, mesh, points, gate)
    fine = _refined(points, mesh, middle.taken(lowest), gate, seed if starts > 1 else None)
    kept, finally_ = _minima(fine, mesh, points, gate)
    # Hopeless fits stay after the others, in their order.
    number = np.concatenate([finally_[again], len(kept) + np.arange(len(first) - len(hopeful))])
    others = coarse.matrices[first[len(hopeful) :]]
    return fine.taken(kept), others, np.bincount(number[which], minlength=len(kept)), gate


def _refined(
    points: np.ndarray, mesh: HeadMesh, fit: surface_fit.SurfaceFit, gate: float, seed: int | None
) -> surface_fit.SurfaceFit:
    """Return fits, best first, that one followed to its end; with a seed, to the lowest near."""
    best = fit.taken(np.array([0]))
    if seed is None:
        fine = surface_fit.fit_to_surface(points, mesh, best.matrices, TOLERANCE_MM, gate_mm=gate)
    else:
        fine = surface_fit.lowest_nearby(points, mesh, best, TOLERANCE_MM, gate, seed)
    return fine.joined(fit.taken(np.arange(1, len(fit.matrices))))


def _minima(
    fit: surface_fit.SurfaceFit, mesh: HeadMesh, points: np.ndarray, gate: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the best row of each minimum, and in which minimum each row is, (s,) int."""
    order = surface_fit.costs(fit.distances_mm, gate).argsort(kind="stable")
    first: list[int] = []
    which = np.zeros(len(order), dtype=int)
    for row in order:
        apart = [
            difference_mm(fit.matrices[other], fit.matrices[row], mesh, points) for other in first
        ]
        same = np.flatnonzero(np.array(apart) < SAME_MINIMUM_MM)
        which[row] = same[0] if len(same) else len(first)
        if not len(same):
            first.append(int(row))
    return np.array(first), which


def _common_gate(fit: surface_fit.SurfaceFit, trimmed: bool) -> float:
    """Return one gate for all fits, so that their costs can be compared."""
    return float(surface_fit.gates(fit.distances_mm).min()) if trimmed else np.inf


def _match(
    trace: np.ndarray,
    mesh: HeadMesh,
    fit: surface_fit.SurfaceFit,
    hopeless: np.ndarray,
    ended: np.ndarray,
    gate: float,
) -> surface_checks.SurfaceMatch:
    matrix = fit.matrices[0]
    places = transforms.apply(matrix, trace)
    nearest = mesh.tree.nearest(places)
    offsets = places - nearest.positions
    normals = surface_fit.plane_normals(mesh, offsets, nearest.distances, nearest.triangles)
    is_inlier = nearest.distances <= gate
    rms = float(np.sqrt(np.mean(nearest.distances[is_inlier] ** 2)))
    # Rivals lie elsewhere and fit hardly worse than the best one.
    score = surface_fit.costs(fit.distances_mm, gate)
    is_near = score <= RIVAL_COST * score[0] + 1e-9
    elsewhere = _apart(fit.matrices[0], fit.matrices, mesh) > OTHER_MINIMUM_MM
    for values in (matrix, places, nearest.distances, normals, is_inlier):
        values.flags.writeable = False
    return surface_checks.SurfaceMatch(
        matrix=matrix,
        places_mm=places,
        residuals_mm=nearest.distances,
        normals=normals,
        is_inlier=is_inlier,
        rms_mm=rms,
        inlier_share=float(is_inlier.mean()),
        converged=bool(fit.converged[0]),
        starts=int(ended.sum()),
        best_starts=int(ended[0]),
        spread_mm=float(_apart(matrix, np.vstack([fit.matrices, hopeless]), mesh).max()),
        rivals=int(np.count_nonzero(is_near & elsewhere)),
        slide=surface_checks.slide_of(places[is_inlier], normals[is_inlier], rms, mesh),
    )


def _apart(matrix: np.ndarray, others: np.ndarray, mesh: HeadMesh) -> np.ndarray:
    """Return how far other matrices (s, 4, 4) put the head's center from where one does, mm."""
    center = transforms.apply(transforms.inverse(matrix), mesh.middle)
    return np.linalg.norm(transforms.apply_each(others, center[None])[:, 0] - mesh.middle, axis=1)
