"""How demanding a task is: one index of four difficulties in touching a series of fiducials.

index = L / 100 mm + T / 90° + H + R / 90°

L is the length in mm of the path over the surface from the first to the last fiducial; T the total
turning of the path at the fiducials between, in degrees; H the number of fiducials hidden in the
default (close-up) view; R the total rotation of the tool to stay normal to the skin, in degrees.

Each unit is about one more action: a hand's width of travel, one corner, one change of the view,
one quarter turn of the tool. The weights of 1 are a convention, not a measured effort.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer.head.surface_path import SurfaceGraph
from rastrainer.head.surface_queries import hides, outward_normal

LENGTH_UNIT_MM = 100.0
ANGLE_UNIT_DEG = 90.0

GRAZING_DEG = 75.0
"""A fiducial at a larger angle between normal and eye is unreadable."""


@dataclass(frozen=True)
class Complexity:
    """The four parts of the index.

    Attributes:
        path_length_mm: L.
        turning_deg: T.
        hidden_points: H.
        reorientation_deg: R.
    """

    path_length_mm: float
    turning_deg: float
    hidden_points: int
    reorientation_deg: float

    @property
    def index(self) -> float:
        """The complexity index, without unit."""
        return (
            self.path_length_mm / LENGTH_UNIT_MM
            + self.turning_deg / ANGLE_UNIT_DEG
            + self.hidden_points
            + self.reorientation_deg / ANGLE_UNIT_DEG
        )


def complexity(
    fiducials: np.ndarray, mesh: HeadMesh, graph: SurfaceGraph, eye: np.ndarray
) -> Complexity:
    """Return the complexity of touching `fiducials` in order.

    Args:
        fiducials: (n, 3) float, on the surface, RAS mm.
        mesh: the head, RAS mm.
        graph: the paths over that mesh.
        eye: (3,) float, the position of the default view, RAS mm.
    """
    fiducials = np.asarray(fiducials, dtype=float)
    normals = np.array([outward_normal(mesh, point) for point in fiducials])
    return Complexity(
        path_length_mm=sum(
            graph.distance(start, end) for start, end in itertools.pairwise(fiducials)
        ),
        turning_deg=float(
            turns_deg(fiducials[:-2], fiducials[1:-1], fiducials[2:], normals[1:-1]).sum()
        ),
        hidden_points=sum(
            is_hidden(point, normal, mesh, eye)
            for point, normal in zip(fiducials, normals, strict=True)
        ),
        reorientation_deg=float(angles_deg(normals[:-1], normals[1:]).sum()),
    )


def turns_deg(
    before: np.ndarray, at: np.ndarray, after: np.ndarray, normals: np.ndarray
) -> np.ndarray:
    """Return the turning of paths at points, seen along the skin's normals there, degrees (n,).

    A path straight over curved skin does not turn. Shapes (n, 3).
    """
    return angles_deg(_in_plane(at - before, normals), _in_plane(after - at, normals))


def is_hidden(point: np.ndarray, normal: np.ndarray, mesh: HeadMesh, eye: np.ndarray) -> bool:
    """Return whether the number at `point` is hidden from `eye`; all (3,)."""
    angle = angles_deg(normal[None], (eye - point)[None])[0]
    return bool(angle > GRAZING_DEG) or hides(mesh, eye, point)


def angles_deg(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the angles (n,) between vectors (n, 3), degrees; 0 where one has no length."""
    across = np.linalg.norm(np.cross(a, b), axis=1)
    return np.degrees(np.arctan2(across, np.einsum("ij,ij->i", a, b)))


def _in_plane(vectors: np.ndarray, normals: np.ndarray) -> np.ndarray:
    return vectors - normals * np.einsum("ij,ij->i", vectors, normals)[:, None]
