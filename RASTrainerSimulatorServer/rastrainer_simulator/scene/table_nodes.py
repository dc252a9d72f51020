"""The table on which the robot stands, and the stand that holds the head."""

from __future__ import annotations

import numpy as np

from rastrainer.scenario import Furniture
from rastrainer_simulator.scene.materials import DARK, MAT, STEEL, TABLE_TOP
from rastrainer_simulator.scene.nodes import Node, Surface, merged
from rastrainer_simulator.scene.room_nodes import FLOOR_HEIGHT
from rastrainer_simulator.scene.solids import post, soft_box, turned

MM_IN_M = 1000.0
LEG_RADIUS = 0.028
LEG_INSET = 0.09
RAIL = 0.02
INTO_TABLE = 0.02
"""How far the stand reaches into the table: a trial's head may stand that much higher."""
COLLAR = 1.8
"""Radius of the collar around the stand's foot, in radii of the stand: it has room to move."""


def table_node(furniture: Furniture, head_base: np.ndarray) -> Node:
    """Return the table, whose top is the plane z = 0 of World.

    `head_base` (3,) float, World, m, is the middle of the head's base in the nominal pose: below
    it are a mat and the collar of the stand.
    """
    width, depth, thickness = furniture.table_size / MM_IN_M
    x, y = furniture.table_center / MM_IN_M
    left, right, near, far = x - width / 2, x + width / 2, y - depth / 2, y + depth / 2
    made = [soft_box((left, right), (near, far), (-thickness, 0.0), TABLE_TOP, 0.04, 0.008)]
    legs_x, legs_y = (left + LEG_INSET, right - LEG_INSET), (near + LEG_INSET, far - LEG_INSET)
    for leg_x in legs_x:
        for leg_y in legs_y:
            made.append(post(leg_x, leg_y, (FLOOR_HEIGHT + 0.03, -thickness), LEG_RADIUS, STEEL))
            foot = (FLOOR_HEIGHT, FLOOR_HEIGHT + 0.03)
            made.append(post(leg_x, leg_y, foot, 1.4 * LEG_RADIUS, DARK))
    for height in (-0.1, FLOOR_HEIGHT + 0.16):
        rails = (height - RAIL, height + RAIL)
        made += [soft_box(legs_x, (y - RAIL, y + RAIL), rails, STEEL, 0.01) for y in legs_y]
        made += [soft_box((x - RAIL, x + RAIL), legs_y, rails, STEEL, 0.01) for x in legs_x]
    return Node("table", merged([*made, *_under_stand(furniture, head_base)]))


def stand_node(furniture: Furniture, head_base: np.ndarray) -> Node:
    """Return the post under the head; its origin, in the middle of its top, is moved."""
    radius = furniture.stand_diameter / 2.0 / MM_IN_M
    bottom = -float(head_base[2]) - INTO_TABLE
    profile = [(radius, bottom), (radius, -0.012), (radius - 0.004, -0.002)]
    return Node("stand", merged([turned(0.0, 0.0, profile, STEEL)]))


def _under_stand(furniture: Furniture, head_base: np.ndarray) -> list[Surface]:
    x, y, _ = head_base
    radius = COLLAR * furniture.stand_diameter / 2.0 / MM_IN_M
    profile = [(radius, 0.0), (radius, 0.008), (radius - 0.006, 0.014)]
    return [
        turned(x, y, profile, STEEL),
        soft_box((x - 0.2, x + 0.2), (y - 0.22, y + 0.22), (-0.004, 0.003), MAT, 0.03, 0.001),
    ]
