"""Virtual trainees who trace a head with guidance or in strokes, and what their traces reveal."""

from __future__ import annotations

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.surface_error import DAB, PoseKnowledge, TraceGuide

TARGET = np.array([0.7815, -16.9395, 1.432])
EYE = np.array([0.8, 583.1, 221.4])
"""The scenario's target, and the eye of its close-up, RAS mm."""
AIMED_MM = 3.0
"""Standard deviation, on each axis, of where a hand begins that aims at the ring."""
EACH_LOOK = 4
"""Points that are drawn between two glances at the ring."""
SHORTEST, LONGEST = 20, 60
"""Length of a stroke without guidance, in points, which are 1 mm apart."""


def draw_by_guidance(head: HeadMesh, guide: TraceGuide, seed: int, count: int) -> np.ndarray:
    """Return points (count, 3) of a hand that knows nothing but where the ring is.

    It begins about there, draws straight in any direction, and lifts when the ring has moved.
    """
    random = np.random.default_rng(seed)
    places = np.zeros((0, 3))
    while len(places) < count:
        ring = guide.next_place(places, is_drawing=False)
        assert ring is not None
        at = ring.position + random.normal(0.0, AIMED_MM, 3)
        heading = random.normal(0.0, 1.0, 3)
        shown = ring
        while shown is not None and shown.vertex == ring.vertex and len(places) < count:
            for _ in range(EACH_LOOK):
                at = head.skin.tree.nearest(at[None]).positions[0]
                places = np.concatenate([places, at[None]])
                heading = _along_skin(head, at, heading)
                # Back toward the ring, if the path has passed it.
                heading = heading if np.linalg.norm(at - ring.position) < 0.8 * DAB else -heading
                at = at + heading
            shown = guide.next_place(places, is_drawing=True)
    return places[:count]


def draw_in_strokes(
    head: HeadMesh, rows: np.ndarray, random: np.random.Generator, count: int
) -> np.ndarray:
    """Return points (count, 3) of a hand without guidance: straight strokes along the skin.

    Each begins at any of some vertices (rows), and goes in any direction.
    """
    lengths = random.integers(SHORTEST, LONGEST + 1, -(-count // SHORTEST))
    at = head.vertices[random.choice(rows, len(lengths))]
    heading = random.normal(size=at.shape)
    path = []
    for _ in range(LONGEST):
        nearest = head.skin.tree.nearest(at)
        path.append(nearest.positions)
        normals = head.skin.triangle_normals[nearest.triangles]
        heading -= np.einsum("ij,ij->i", heading, normals)[:, None] * normals
        heading /= np.linalg.norm(heading, axis=1, keepdims=True)
        at = nearest.positions + heading
    strokes = np.stack(path, axis=1)
    return np.concatenate(
        [stroke[:length] for stroke, length in zip(strokes, lengths, strict=True)]
    )[:count]


def expected_mm(knowledge: PoseKnowledge, targets: np.ndarray) -> np.ndarray:
    """Return √E[TRE²] at targets (m, 3), RAS mm, (m,) float, mm, without an offset they share."""
    return np.sqrt(np.trace(knowledge.at_targets(targets), axis1=1, axis2=2))


def _along_skin(head: HeadMesh, at: np.ndarray, heading: np.ndarray) -> np.ndarray:
    normal = head.vertex_normals[np.linalg.norm(head.vertices - at, axis=1).argmin()]
    along = heading - (heading @ normal) * normal
    return along / np.linalg.norm(along)
