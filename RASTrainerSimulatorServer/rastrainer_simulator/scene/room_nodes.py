"""The room around the robot: floor, walls, table and the stand that holds the head."""

from __future__ import annotations

import numpy as np
import trimesh

from rastrainer.scenario import Furniture
from rastrainer_simulator.scene.materials import (
    FLOOR,
    MAT,
    STEEL,
    TABLE_TOP,
    WALL,
    WALL_BAND,
    Material,
)
from rastrainer_simulator.scene.nodes import Node, Surface, merged
from rastrainer_simulator.scene.shading import shaded

MM_IN_M = 1000.0
LEG_RADIUS = 0.025
LEG_INSET = 0.08
FLOOR_HEIGHT = -0.78
ROOM = ((-2.6, 3.2), (-3.2, 1.9))
WALL_TOP = 1.9
WALL_BAND_HEIGHTS = (-0.02, 0.16)


def room_nodes(furniture: Furniture) -> list[Node]:
    """Return table, floor and room; the table's top is the plane z = 0 of World."""
    return [
        Node("table", merged(_table(furniture))),
        Node("floor", (_box(*ROOM, (FLOOR_HEIGHT - 0.01, FLOOR_HEIGHT), FLOOR),)),
        Node("room", merged(_walls())),
    ]


def stand_node(furniture: Furniture, height: float) -> Node:
    """Return the post under the head; its origin, in the middle of its top, is moved.

    `height` (m) is that of the base of the head above the table in the nominal pose.
    """
    radius = furniture.stand_diameter / 2.0 / MM_IN_M
    return Node("stand", merged([_post(0.0, 0.0, -height - 0.02, -0.001, radius)]))


def _table(furniture: Furniture) -> list[Surface]:
    width, depth, thickness = furniture.table_size / MM_IN_M
    x, y = furniture.table_center / MM_IN_M
    left, right, near, far = x - width / 2, x + width / 2, y - depth / 2, y + depth / 2
    legs = [
        _post(leg_x, leg_y, FLOOR_HEIGHT, -thickness, LEG_RADIUS)
        for leg_x in (left + LEG_INSET, right - LEG_INSET)
        for leg_y in (near + LEG_INSET, far - LEG_INSET)
    ]
    return [_box((left, right), (near, far), (-thickness, 0.0), TABLE_TOP), *legs]


def _walls() -> list[Surface]:
    """Return four walls with a colored band and skirting; there is no ceiling."""
    (left, right), (near, far) = ROOM
    bands = ((*WALL_BAND_HEIGHTS, WALL_BAND), (FLOOR_HEIGHT, FLOOR_HEIGHT + 0.1, WALL_BAND))
    made = []
    for low, high, material in ((FLOOR_HEIGHT, WALL_TOP, WALL), *bands):
        out = 0.0 if material is WALL else 0.002
        for x in ((left - 0.1, left + out), (right - out, right + 0.1)):
            made.append(_box(x, (near, far), (low, high), material))
        for y in ((near - 0.1, near + out), (far - out, far + 0.1)):
            made.append(_box((left, right), y, (low, high), material))
    return made


def _box(
    x: tuple[float, float], y: tuple[float, float], z: tuple[float, float], material: Material
) -> Surface:
    box = trimesh.creation.box(bounds=np.array([x, y, z]).T)
    return shaded(box.vertices, box.faces, material)


def _post(x: float, y: float, bottom: float, top: float, radius: float) -> Surface:
    """Return an upright steel cylinder."""
    ends = np.array([[x, y, bottom], [x, y, top]])
    cylinder = trimesh.creation.cylinder(radius, segment=ends, sections=48)
    return shaded(cylinder.vertices, cylinder.faces, STEEL)
