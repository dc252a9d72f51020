"""Closed solids from simple shapes: revolved outlines, boxes, prisms, and their cuts and unions."""

from __future__ import annotations

from collections.abc import Sequence

import manifold3d
import numpy as np
import trimesh

Outline = Sequence[tuple[float, float]]


def revolve(outline: Outline, segments: int) -> trimesh.Trimesh:
    """Turn an outline of (radius, z) points, from bottom to top, about the z axis."""
    closed = np.array([(0.0, outline[0][1]), *outline, (0.0, outline[-1][1])])
    return trimesh.creation.revolve(closed, sections=segments)


def enclosing(outline: Outline, segments: int) -> Outline:
    """Widen an outline so that the flat sides of its solid touch the round one it stands for."""
    return [(radius / np.cos(np.pi / segments), z) for radius, z in outline]


def cylinder(radius: float, bottom: float, top: float, segments: int) -> trimesh.Trimesh:
    """Return a cylinder about the z axis between two heights."""
    return revolve(((radius, bottom), (radius, top)), segments)


def box(low: Sequence[float], high: Sequence[float]) -> trimesh.Trimesh:
    """Return the box between two corners."""
    return trimesh.creation.box(bounds=[low, high])


def hull(points: np.ndarray) -> trimesh.Trimesh:
    """Return the convex hull of (n, 3) float points."""
    return trimesh.convex.convex_hull(points)


def union(*solids: trimesh.Trimesh) -> trimesh.Trimesh:
    """Join solids into one."""
    return trimesh.boolean.union(list(solids), engine="manifold")


def difference(solid: trimesh.Trimesh, *tools: trimesh.Trimesh) -> trimesh.Trimesh:
    """Cut tools out of a solid."""
    return trimesh.boolean.difference([solid, *tools], engine="manifold")


def trim(solid: trimesh.Trimesh, normal: Sequence[float], offset: float) -> trimesh.Trimesh:
    """Keep what lies on the side of a plane that its unit `normal` points to, and close the cut.

    The plane holds the points p with normal · p = offset.
    """
    mesh = manifold3d.Mesh(
        np.asarray(solid.vertices, dtype=np.float32), np.asarray(solid.faces, dtype=np.uint32)
    )
    kept = manifold3d.Manifold(mesh).trim_by_plane(tuple(normal), offset).to_mesh()
    return trimesh.Trimesh(kept.vert_properties[:, :3], kept.tri_verts, process=False)


def moved(
    solid: trimesh.Trimesh, offset: Sequence[float] = (0, 0, 0), turn_z_deg: float = 0.0
) -> trimesh.Trimesh:
    """Return a copy turned about the z axis, then shifted."""
    matrix = trimesh.transformations.rotation_matrix(np.radians(turn_z_deg), (0, 0, 1))
    matrix[:3, 3] = offset
    return solid.copy().apply_transform(matrix)
