"""Take the face out of a head's images, as `rastrainer.face_removal` takes it off its surface."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from vtkmodules.vtkFiltersCore import vtkImplicitPolyDataDistance

from rastrainer.face_removal import RADIUS_MM, face_vertices, nose_tip, without_face
from rastrainer.head_mesh import HeadMesh
from rastrainer.head_volume import KEPT_MM, HeadVolume
from rastrainer_simulator.scenarios.voxels import Grid
from rastrainer_simulator.views.actors import surface

LEAST_DEPTH_MM = 15.0
"""So much behind the shield that takes the face's place is taken out, too."""

BEHIND_FACE_MM = 4.0
"""At least so much behind the deepest place of the face, which may lie behind the shield."""

BEYOND_MM = 4.0
"""Around the face's own radius."""

_SAMPLES = 6
"""Along each side of a triangle, whose sides are about two millimeters."""


def without_face_in(volume: HeadVolume, head: HeadMesh) -> HeadVolume:
    """Return the images of a head with nothing in the place of its face, nor around the head.

    What ends there depends on the shield of `without_face`, not on the face: the images tell no
    more about it than the surface that is given with them.

    Args:
        volume: the images.
        head: with its face.
    """
    shield, tip = without_face(head), nose_tip(head)
    grid = Grid(volume.values.shape, volume.ijk_to_ras)
    values, nothing = volume.values.copy(), volume.values.min()
    values[grid.distances(grid.inside(head)) > KEPT_MM] = nothing
    around = grid.around(tip, RADIUS_MM + BEYOND_MM)
    part = grid.part(around)
    is_near = np.linalg.norm(part.places() - tip, axis=-1) < RADIUS_MM + BEYOND_MM
    is_face = face_vertices(head)
    to_shield = part.distances(part.at(_samples(shield, is_face)))
    is_taken = ~part.inside(shield) | (to_shield < _depth(head.vertices[is_face], shield))
    values[around][is_near & is_taken] = nothing
    return replace(volume, values=values)


def _samples(mesh: HeadMesh, is_wanted: np.ndarray) -> np.ndarray:
    """Return places (n, 3), RAS mm, all over the triangles that have a wanted corner."""
    corners = mesh.vertices[mesh.triangles[is_wanted[mesh.triangles].any(axis=1)]]
    steps = np.arange(_SAMPLES + 1) / _SAMPLES
    weights = np.array([(a, b, 1.0 - a - b) for a in steps for b in steps if a + b < 1.0 + 1e-9])
    return np.einsum("wc,tcx->wtx", weights, corners).reshape(-1, 3)


def _depth(face: np.ndarray, shield: HeadMesh) -> float:
    """Return how much behind the shield (mm) no place (n, 3) of the face is left."""
    signed = vtkImplicitPolyDataDistance()
    signed.SetInput(surface(shield.vertices, shield.triangles))
    deepest = max((-signed.EvaluateFunction(place) for place in face.astype(float)), default=0.0)
    return max(LEAST_DEPTH_MM, deepest + BEHIND_FACE_MM)
