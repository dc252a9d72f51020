"""Traces over the skin of Colin27 whose true pose is known."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.head.mesh import HeadMesh, read_head_mesh

COLIN27 = Path(__file__).parents[3] / "assets" / "scenarios" / "colin27"


@lru_cache(maxsize=1)
def colin27() -> HeadMesh:
    return read_head_mesh(COLIN27 / "head.ply")


def places(mesh: HeadMesh, where: str) -> np.ndarray:
    """The vertices, as indices, of a region of Colin27's skin, scaled to a head's box.

    `side` is the right half of the head, from temple to behind the ear.
    """
    own = colin27()
    lowest = own.middle - own.size / 2.0
    x, y, z = ((mesh.vertices - mesh.vertices.min(axis=0)) * (own.size / mesh.size) + lowest).T
    if where == "face":
        return np.flatnonzero((y > 30) & (z > -55) & (z < 60) & (mesh.vertex_normals[:, 1] > 0.1))
    if where == "side":
        return np.flatnonzero((x > 45) & (y > -80) & (y < 60) & (z > -55) & (z < 60))
    if where == "crown":
        return np.flatnonzero(z > 85)
    raise ValueError(where)


def head_pose(random: np.random.Generator) -> np.ndarray:
    """RAS→World: turned at will, and up to some decimeters away."""
    return transforms.rigid(
        transforms.rotations(random.normal(0, 1, (1, 3)))[0], random.normal(0, 200, 3)
    )


def coarse_start(
    random: np.random.Generator, head_to_world: np.ndarray, sd_mm: float = 3.0, sd_deg: float = 3.0
) -> np.ndarray:
    """World→RAS as three landmarks give it."""
    turn = transforms.rotations(np.radians(random.normal(0, sd_deg, (1, 3))))[0]
    off = transforms.rigid(turn, random.normal(0, sd_mm, 3))
    return off @ transforms.inverse(head_to_world)


def traced(
    mesh: HeadMesh,
    rows: np.ndarray,
    random: np.random.Generator,
    head_to_world: np.ndarray,
    noise_mm: float,
    count: int = 200,
) -> np.ndarray:
    """Points on the skin at random vertices, with noise across it, in World."""
    rows = random.choice(rows, count)
    off = random.normal(0.0, noise_mm, (count, 1)) * mesh.vertex_normals[rows]
    return transforms.apply(head_to_world, mesh.vertices[rows] + off)


def error_at_center(matrix: np.ndarray, head_to_world: np.ndarray, mesh: HeadMesh) -> float:
    return float(
        np.linalg.norm(transforms.apply(matrix @ head_to_world, mesh.middle) - mesh.middle)
    )


def random_walk(
    mesh: HeadMesh, allowed: np.ndarray, random: np.random.Generator, count: int
) -> np.ndarray:
    """Vertices along a path over the skin that turns at will, like a random drawing."""
    neighbors: dict[int, list[int]] = {}
    for a, b in mesh.edges[allowed[mesh.edges].all(axis=1)].tolist():
        neighbors.setdefault(a, []).append(b)
        neighbors.setdefault(b, []).append(a)
    rows = [int(random.choice(list(neighbors)))]
    heading = random.normal(size=3)
    while len(rows) < count:
        heading = heading + 0.5 * random.normal(size=3)
        heading /= np.linalg.norm(heading)
        steps = mesh.vertices[neighbors[rows[-1]]] - mesh.vertices[rows[-1]]
        along = steps @ heading
        if along.max() <= 0.0:
            heading = -heading
        rows.append(neighbors[rows[-1]][int(along.argmax())])
    return np.array(rows)
