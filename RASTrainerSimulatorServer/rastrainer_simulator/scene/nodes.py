"""A scene as values: named nodes with surfaces and physically based materials; lengths in m."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

Color = tuple[float, float, float]


@dataclass(frozen=True)
class Material:
    """A surface's color (sRGB, 0…1), roughness, metallicity and opacity; it may glow by itself."""

    name: str
    color: Color
    roughness: float = 0.5
    metallic: float = 0.0
    glowing: bool = False
    opacity: float = 1.0

    @property
    def linear_color(self) -> Color:
        """The color as light, as glTF and physically based shading want it (IEC 61966-2-1)."""
        red, green, blue = (
            value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
            for value in self.color
        )
        return red, green, blue


TOOL = "tool"


def link_node_name(joint: int) -> str:
    return f"link_{joint}"


TIP_MARKER = "tip_marker"
NO_GO_PREFIX = "no_go_"
"""Name of the node at the tip, and how the names of no-go structures begin."""
SKIN = Material("skin", (0.87, 0.67, 0.56), 0.55)
STEEL = Material("steel", (0.76, 0.77, 0.78), 0.35, 0.6)
TABLE_TOP = Material("table_top", (0.68, 0.70, 0.70), 0.45)
MAT = Material("mat", (0.22, 0.45, 0.50), 0.85)
FLOOR = Material("floor", (0.50, 0.55, 0.58), 0.5)
FLOOR_BORDER = Material("floor_border", (0.36, 0.43, 0.47), 0.5)
WALL = Material("wall", (0.91, 0.92, 0.91), 0.85)
WALL_BAND = Material("wall_band", (0.58, 0.71, 0.72), 0.8)
WALL_SEAM = Material("wall_seam", (0.72, 0.75, 0.75), 0.9)
DOOR = Material("door", (0.66, 0.76, 0.77), 0.6)
CABINET = Material("cabinet", (0.83, 0.86, 0.87), 0.5)
DARK = Material("dark", (0.13, 0.15, 0.17), 0.35)
DISPLAY = Material("display", (0.05, 0.10, 0.14), glowing=True)
TRACE = Material("trace", (0.30, 0.62, 0.60), glowing=True)
LAMP_GLASS = Material("lamp_glass", (0.96, 0.97, 0.94), glowing=True)

TIP_FREE = Material("tip_free", (0.06, 0.27, 0.91), glowing=True)
TIP_NEAR = Material("tip_near", (0.29, 0.65, 1.0), glowing=True)
TIP_ON_SKIN = Material("tip_on_skin", (0.65, 1.0, 0.40), glowing=True)
TIP_ERROR = Material("tip_error", (0.78, 0.0, 0.10), glowing=True)

WAITING = Material("waiting", (0.07, 0.20, 0.60), glowing=True)
NEXT = Material("next", (1.0, 0.88, 0.29), glowing=True)
TOUCHED = Material("touched", (0.18, 0.60, 0.29), glowing=True)
MARK_RIM = Material("rim", (0.97, 0.97, 0.97), glowing=True)
NUMBER = Material("number", (0.07, 0.09, 0.16), glowing=True)
ARROW = Material("arrow", (0.16, 0.22, 0.38), glowing=True)

TRACED = Material("traced", (0.02, 0.13, 0.42), glowing=True)
COVERED = Material("covered", (0.34, 0.71, 0.91), 0.55)
"""Traced points, and the skin around them: blues that color-blind people can tell from skin."""

GHOST = Material("ghost", (0.50, 0.34, 0.90))
GHOST_OPACITY = 0.45


GUIDE = Material("guide", (0.86, 0.88, 0.90), 0.3, 0.5)
AXIS = Material("axis", (0.75, 0.95, 1.0), glowing=True)
DRILL = Material("drill", (0.55, 0.57, 0.60), 0.3, 0.7)
ELECTRODE = Material("electrode", (0.35, 0.65, 1.0), glowing=True)
NO_GO = Material("no_go", (0.86, 0.20, 0.25), 0.6, opacity=0.45)


def painted(color: Sequence[float]) -> Material:
    """Return the coating of a robot part: the color its URDF names, a little glossy."""
    red, green, blue = (float(value) for value in color[:3])
    name = "paint_" + "".join(f"{round(255 * value):02x}" for value in (red, green, blue))
    return Material(name, (red, green, blue), 0.38)


@dataclass(frozen=True)
class Surface:
    """Triangles (m, 3) of one material, in their node's frame, counterclockwise seen from outside.

    Vertices, m, and normals are (n, 3) float.
    """

    vertices: np.ndarray
    normals: np.ndarray
    triangles: np.ndarray
    material: Material


@dataclass(frozen=True)
class Node:
    """A part of the scene that can be moved with its children, colored or hidden by its name.

    It has at most one surface of each material. If `is_hidden`, pictures leave it out unless
    something asks for it.
    """

    name: str
    surfaces: tuple[Surface, ...] = ()
    children: tuple[Node, ...] = ()
    is_hidden: bool = False

    def walk(self) -> Iterator[Node]:
        """Yield this node and all below it, parents first."""
        yield self
        for child in self.children:
            yield from child.walk()


def no_go_name(path: Path) -> str:
    return f"{NO_GO_PREFIX}{path.stem}"


def merged(surfaces: list[Surface]) -> tuple[Surface, ...]:
    """Return one surface for each material: fewer surfaces are drawn faster."""
    by_material: dict[Material, list[Surface]] = {}
    for surface in surfaces:
        by_material.setdefault(surface.material, []).append(surface)
    joined = []
    for material, group in by_material.items():
        starts = np.cumsum([0, *(len(surface.vertices) for surface in group[:-1])])
        triangles = [s.triangles + start for s, start in zip(group, starts, strict=True)]
        vertices = np.concatenate([surface.vertices for surface in group])
        normals = np.concatenate([surface.normals for surface in group])
        joined.append(Surface(vertices, normals, np.concatenate(triangles), material))
    return tuple(joined)
