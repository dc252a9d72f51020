"""A scene as values: named nodes with surfaces; lengths in m."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.scene.materials import Material


@dataclass(frozen=True)
class Surface:
    """Triangles of one material, in their node's frame.

    Attributes:
        vertices: (n, 3) float, m.
        normals: (n, 3) float, unit vectors.
        triangles: (m, 3) int, counterclockwise seen from outside.
        material: of all of it.
    """

    vertices: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    material: Material


@dataclass(frozen=True)
class Node:
    """Something that can be moved, colored or hidden by its name.

    Attributes:
        name: unique in the scene.
        surfaces: at most one of each material.
        children: what moves with it.
        pose: (4, 4) float, to the parent's frame; None for where the parent is.
    """

    name: str
    surfaces: tuple[Surface, ...] = ()
    children: tuple[Node, ...] = ()
    pose: np.ndarray | None = None

    def walk(self) -> Iterator[Node]:
        """Yield this node and all below it, parents first."""
        yield self
        for child in self.children:
            yield from child.walk()


def merged(surfaces: list[Surface]) -> tuple[Surface, ...]:
    """Return one surface for each material: what is drawn in one go costs a view least."""
    by_material: dict[Material, list[Surface]] = {}
    for surface in surfaces:
        by_material.setdefault(surface.material, []).append(surface)
    return tuple(_joined(group) for group in by_material.values())


def _joined(group: list[Surface]) -> Surface:
    starts = np.cumsum([0, *(len(surface.vertices) for surface in group[:-1])])
    return Surface(
        np.concatenate([surface.vertices for surface in group]),
        np.concatenate([surface.normals for surface in group]),
        np.concatenate([s.triangles + start for s, start in zip(group, starts, strict=True)]),
        group[0].material,
    )
