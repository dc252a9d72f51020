"""How far it is at least from the first fiducial through all to the last, around the head."""

from __future__ import annotations

import numpy as np

from rastrainer.head_mesh import HeadMesh
from rastrainer.surface_path import SurfaceGraph
from rastrainer.surface_queries import hides, outward_normal


def shortest_path_mm(fiducials: np.ndarray, mesh: HeadMesh, graph: SurfaceGraph) -> float:
    """Return the length of the shortest free path through (n, 3) fiducials in their order, in mm.

    From each to the next it is the straight line where the head is not in the way, else the way
    over the skin, which the graph makes about 2.5 % too long. It takes about half a second.
    """
    fiducials = np.asarray(fiducials, dtype=float)
    normals = [outward_normal(mesh, point) for point in fiducials]
    return sum(
        float(np.linalg.norm(fiducials[i + 1] - fiducials[i]))
        if _is_free(mesh, fiducials[i : i + 2], normals[i : i + 2])
        else graph.distance(fiducials[i], fiducials[i + 1])
        for i, _ in enumerate(fiducials[1:])
    )


def _is_free(mesh: HeadMesh, ends: np.ndarray, normals: list[np.ndarray]) -> bool:
    """Tell whether the straight line leaves the skin outward at both ends and meets nothing."""
    along = ends[1] - ends[0]
    if along @ normals[0] <= 0 or -along @ normals[1] <= 0:
        return False
    # The first triangle met would be the one that the line starts on.
    return not hides(mesh, ends[0] + along / np.linalg.norm(along), ends[1])
