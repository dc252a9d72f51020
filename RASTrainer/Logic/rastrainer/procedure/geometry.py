"""Straight instruments: where a line goes through bone, and how near it comes to a structure."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from rastrainer.head.mesh import HeadMesh, mesh_crossings, nearest_on_mesh, normal_at

DIPLOE_MM = 5.0
"""Gaps in bone up to this length belong to it: the marrow between both tables is dark in a CT."""


class BoneAhead(NamedTuple):
    """Where a line goes through the outer and the inner table, as distances from its start in mm.

    The inner is None if the line does not leave the bone.
    """

    outer_mm: float
    inner_mm: float | None


def bone_ahead(
    skull: HeadMesh, start: np.ndarray, direction: np.ndarray, length_mm: float
) -> BoneAhead | None:
    """Return where a line first goes through bone, or None if it does not.

    It starts outside of the skull, (3,), mm, in its frame; the direction (3,) is a unit vector.
    """
    outer = inner = None
    for distance, is_entering in mesh_crossings(skull, start, direction, length_mm):
        if outer is None:
            outer = distance if is_entering else None
        elif not is_entering:
            inner = distance
        elif inner is not None and distance - inner > DIPLOE_MM:
            break
    return None if outer is None else BoneAhead(outer, inner)


def angle_deg(a: np.ndarray, b: np.ndarray) -> float:
    """Return the angle between two directions (3,), in degrees.

    The arc tangent is exact for small angles, too (Kahan 2006).
    """
    return float(np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b)), a @ b)))


def skull_angle_deg(skull: HeadMesh, point: np.ndarray, direction: np.ndarray) -> float:
    """Return the angle between a direction into the head and the skull's inward normal, degrees.

    The line enters it at `point` (3,), mm, along a unit vector (3,).
    """
    return angle_deg(-normal_at(skull, nearest_on_mesh(skull, point)), direction)


def is_inside(mesh: HeadMesh, point: np.ndarray) -> bool:
    """Return whether a point (3,), in mm, is within a closed surface."""
    far = float(np.linalg.norm(mesh.vertices - point, axis=1).max()) + 1.0
    # No direction of a symmetric mesh.
    direction = np.array([0.31, 0.52, 0.79])
    crossings = mesh_crossings(mesh, point, direction / np.linalg.norm(direction), far)
    return bool(crossings) and not crossings[0].is_entering


def axis_distance_mm(mesh: HeadMesh, start: np.ndarray, end: np.ndarray) -> float:
    """Return the distance of a straight segment from a closed body, 0 if they meet.

    Unless they meet, the shortest path to a triangle begins at an end of the segment, or ends on a
    side of the triangle. Start and end (3,), mm, are in the frame of the mesh.
    """
    length = float(np.linalg.norm(end - start))
    if is_inside(mesh, start):
        return 0.0
    least = min(nearest_on_mesh(mesh, point).distance for point in (start, end))
    if length == 0.0:
        return least
    if mesh_crossings(mesh, start, (end - start) / length, length):
        return 0.0
    centers, radii = mesh.triangle_spheres
    share = np.clip((centers - start) @ (end - start) / length**2, 0.0, 1.0)
    to_segment = np.linalg.norm(start + share[:, None] * (end - start) - centers, axis=1) - radii
    near = mesh.vertices[mesh.triangles[to_segment <= least]]
    for first, second in ((0, 1), (1, 2), (2, 0)):
        sides = segment_distances_mm(start, end, near[:, first], near[:, second])
        least = min(least, float(sides.min(initial=np.inf)))
    return least


def segment_distances_mm(
    start: np.ndarray, end: np.ndarray, starts: np.ndarray, ends: np.ndarray
) -> np.ndarray:
    """Return the distances between one segment and others, (n,) float, mm.

    The closest points of both lines, clamped to the segments (Ericson 2005, Real-Time Collision
    Detection, 5.1.9). Start and end are (3,), and differ; the others' (n, 3) may be the same point.
    """
    along, others, offset = end - start, ends - starts, start - starts
    aa = float(along @ along)
    bb = np.maximum(np.einsum("ij,ij->i", others, others), 1e-30)
    ab, ao = others @ along, offset @ along
    bo = np.einsum("ij,ij->i", others, offset)
    area = aa * bb - ab**2
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.where(area > 1e-12 * aa * bb, (ab * bo - ao * bb) / area, 0.0).clip(0.0, 1.0)
    t = (ab * s + bo) / bb
    s = np.where(t < 0.0, -ao / aa, np.where(t > 1.0, (ab - ao) / aa, s)).clip(0.0, 1.0)
    t = t.clip(0.0, 1.0)
    between = offset + s[:, None] * along - t[:, None] * others
    return np.linalg.norm(between, axis=1)
