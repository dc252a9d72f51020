"""Remove the face from a head's surface, so that the person cannot be recognized.

The skin around the tip of the nose, from the brows to the chin, is replaced by a smooth shield:
each vertex gets the mean direction, height and distance of its neighbors as seen from the head's
vertical axis (Tutte 1963), so the shield depends only on its rim. Vertices are moved, never added
or removed: the surface stays closed.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse.csgraph
import scipy.sparse.linalg

from rastrainer.errors import InputError
from rastrainer.head.mesh import FLAT_MM, HeadMesh

RADIUS_MM = 72.0
"""Around the tip of the nose: the eyes and the mouth are within, the ears and temples are not."""

MIDLINE_MM = 25.0
NOSE_BELOW_TOP_SHARE = (0.45, 0.95)
BESIDE_MM, BESIDE_WITHIN_MM = 18.0, 4.0
LEAST_NOSE_MM = 5.0
"""Measured from the cheeks: noses stand out by 7 mm and more, the back of a head by 1 to 3."""

NOT_BEHIND = 0.5


def face_vertices(mesh: HeadMesh) -> np.ndarray:
    """Return which vertices (n,) bool are the face; none if the head ends above it."""
    return _near_nose(mesh)[0]


def _near_nose(mesh: HeadMesh) -> tuple[np.ndarray, np.ndarray]:
    """Return which vertices (n,) bool around the nose are the face, and which the flat base."""
    heights = mesh.vertices[:, 2]
    is_near = np.linalg.norm(mesh.vertices - nose_tip(mesh), axis=1) < RADIUS_MM
    is_on_base = heights < heights.min() + FLAT_MM
    return is_near & ~is_on_base, is_near & is_on_base


def nose_tip(mesh: HeadMesh) -> np.ndarray:
    """Return the foremost point (3,), RAS mm, of the lower half of the head near the midline."""
    vertices = mesh.vertices
    top, bottom = vertices[:, 2].max(), vertices[:, 2].min()
    below = (top - vertices[:, 2]) / (top - bottom)
    middle = (vertices[:, 0].max() + vertices[:, 0].min()) / 2.0
    low, high = NOSE_BELOW_TOP_SHARE
    candidates = (np.abs(vertices[:, 0] - middle) < MIDLINE_MM) & (below > low) & (below < high)
    places = vertices[candidates] if candidates.any() else vertices
    return places[places[:, 1].argmax()]


def check_front(mesh: HeadMesh) -> str:
    """Return a warning if no nose is found in front of a head; empty if there is one."""
    behind = HeadMesh(mesh.vertices * np.array([-1.0, -1.0, 1.0]), mesh.triangles)
    front, back = _nose_height(mesh), _nose_height(behind)
    if back > LEAST_NOSE_MM and front < NOT_BEHIND * back:
        raise InputError(
            "This head looks backward: its nose is where its back should be (posterior), so the "
            "face would be kept. Make the scenario again with the right orientation of the images."
        )
    if front > LEAST_NOSE_MM:
        return ""
    return "No nose was found in front: the face may be gone already, or be elsewhere."


def _nose_height(mesh: HeadMesh) -> float:
    """Return how far the tip of the nose is in front of the cheeks, mm."""
    tip, vertices = nose_tip(mesh), mesh.vertices
    aside = np.abs(np.abs(vertices[:, 0] - tip[0]) - BESIDE_MM)
    is_beside = (aside < BESIDE_WITHIN_MM) & (np.abs(vertices[:, 2] - tip[2]) < BESIDE_WITHIN_MM)
    return float(tip[1] - vertices[is_beside, 1].max(initial=vertices[:, 1].min()))


def without_face(mesh: HeadMesh) -> HeadMesh:
    """Return the head with a smooth membrane instead of its face."""
    # Where the base cuts through the face its rim would keep the profile: it may slide along.
    free, rim = _near_nose(mesh)
    across, forward, height = (np.asarray(mesh.vertices, dtype=float) - mesh.centroid).T
    distance, direction = np.hypot(across, forward), np.arctan2(across, forward)
    distance, direction = (_relaxed(mesh.edges, x, free | rim) for x in (distance, direction))
    height = _relaxed(mesh.edges, height, free)
    vertices = np.array(mesh.vertices, dtype=float)
    around = distance[:, None] * np.column_stack([np.sin(direction), np.cos(direction)])
    moved = np.column_stack([around, height]) + mesh.centroid
    vertices[free | rim] = moved[free | rim]
    return HeadMesh(vertices, mesh.triangles)


def _relaxed(edges: np.ndarray, values: np.ndarray, moving: np.ndarray) -> np.ndarray:
    """Return values (n,) in which each moving value is the mean of its neighbors."""
    count = len(values)
    ends = scipy.sparse.coo_matrix((np.ones(len(edges)), edges.T), shape=(count, count))
    rows = scipy.sparse.csgraph.laplacian(ends + ends.T).tocsr()[moving]
    result = values.copy()
    if moving.any():
        fixed = rows[:, ~moving] @ values[~moving]
        result[moving] = scipy.sparse.linalg.spsolve(rows[:, moving].tocsc(), -fixed)
    return result
