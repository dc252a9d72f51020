"""The head as it is seen: skin, and numbered fiducials in the color of their state."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from vtkmodules.vtkRenderingCore import vtkActor

from rastrainer.head_mesh import HeadMesh
from rastrainer_simulator.views.actors import actor, surface
from rastrainer_simulator.views.materials import (
    MARK_RIM,
    NEXT,
    NUMBER,
    SKIN,
    TOUCHED,
    WAITING,
    Material,
)
from rastrainer_simulator.views.skin_marks import skin_marks

MM_TO_M = np.diag([0.001, 0.001, 0.001, 1.0])
SKIN_CREASE_DEG = 80.0
BASE_DEPTH = 1.0


@dataclass(frozen=True)
class ShownHead:
    """The head and its fiducials, as they are to be shown.

    Attributes:
        mesh: the skin, RAS mm.
        head_to_world: (4, 4) float, RAS mm to World mm.
        fiducials: (n, 3) float, RAS mm.
        labels: one for each fiducial.
        touched: labels of those that are done.
        next_point: label of the one to touch now.
    """

    mesh: HeadMesh
    head_to_world: np.ndarray
    fiducials: np.ndarray
    labels: Sequence[str]
    touched: frozenset[str] = frozenset()
    next_point: str | None = None

    def base_in_world(self) -> np.ndarray:
        """Return the middle of the flat base on which the head stands, (3,) float, World, m."""
        vertices = self.mesh.vertices
        base = vertices[vertices[:, 2] < vertices[:, 2].min() + BASE_DEPTH]
        middle = (base.min(axis=0) + base.max(axis=0)) / 2.0
        return (MM_TO_M @ self.head_to_world @ np.append(middle, 1.0))[:3]


def head_actors(head: ShownHead) -> list[vtkActor]:
    """Return the actors of skin and marks."""
    skin_to_world = MM_TO_M @ head.head_to_world
    skin = surface(head.mesh.vertices, head.mesh.triangles)
    actors = [actor(skin, SKIN, skin_to_world, SKIN_CREASE_DEG)]
    for mark in skin_marks(head.mesh, head.fiducials, head.labels):
        actors.append(actor(mark.rim, MARK_RIM, skin_to_world))
        actors.append(actor(mark.dot, _state(head, mark.label), skin_to_world))
        actors.append(actor(mark.number, NUMBER, skin_to_world))
    return actors


def _state(head: ShownHead, label: str) -> Material:
    if label in head.touched:
        return TOUCHED
    return NEXT if label == head.next_point else WAITING
