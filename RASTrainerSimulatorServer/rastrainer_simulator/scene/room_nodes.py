"""The room, the robot's table, and the stand that holds the head; `room.json` lists the room."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.scenario.scenario import OperatingTable, Stand
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.scene import nodes
from rastrainer_simulator.scene.nodes import (
    DARK,
    MAT,
    STEEL,
    TABLE_TOP,
    TRACE,
    Material,
    Node,
    Surface,
    merged,
)
from rastrainer_simulator.scene.surfaces import box, post, soft_box, turned

FLOOR_HEIGHT = -0.78
_SHAPES: dict[str, Callable[..., Surface]] = {
    "box": box,
    "soft box": soft_box,
    "post": post,
    "turned": turned,
}
_MATERIALS = {each.name: each for each in vars(nodes).values() if isinstance(each, Material)}


def room_nodes() -> list[Node]:
    """Return floor and room; there is no ceiling, for daylight comes from above."""
    room = json.loads(Path(__file__).with_name("room.json").read_text(encoding="utf-8"))
    return [
        Node(name, merged([surface for part in parts for surface in _surfaces(**part)]))
        for name, parts in room.items()
    ]


def _surfaces(shape: str, material: str = "", **sizes: Any) -> list[Surface]:
    if shape == "trace":
        return _trace(**sizes)
    if "pose" in sizes:
        sizes["pose"] = np.array(sizes["pose"])
    return [_SHAPES[shape](**sizes, material=_MATERIALS[material])]


def _trace(left: float, width: float, y: float, middle: float, height: float) -> list[Surface]:
    """Return the ECG line of five heartbeats, as little bars."""
    count = 60
    beat = np.arange(count) % 12
    level = np.where(beat == 5, 1.0, np.where(beat == 6, -0.35, np.where(beat == 9, 0.22, 0.0)))
    step, line = width / count, 0.05 * height
    made = []
    for index, value in enumerate(level):
        low, high = sorted((0.0, float(value) * height))
        x = left + index * step
        made.append(box((x, x + step), (y, y + 0.001), (middle + low, middle + high + line), TRACE))
    return made


LEG_RADIUS = 0.028
LEG_INSET = 0.09
RAIL = 0.02
INTO_TABLE = 0.02
"""How far the stand reaches into the table: a trial's head may be that much higher."""
COLLAR = 1.8
"""Radius of the collar around the stand's foot, in radii of the stand, with room to move."""


def table_node(table: OperatingTable, stand: Stand, head_base: np.ndarray) -> Node:
    """Return the table, whose top is the plane z = 0 of World.

    `head_base` (3,) float, World, m, is the middle of the head's base in the nominal pose: below
    it are a mat and the collar of the stand.
    """
    width, depth, thickness = np.array(table.size_mm) / MM_PER_M
    x, y = np.array(table.center_mm) / MM_PER_M
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
    radius = COLLAR * stand.diameter_mm / 2.0 / MM_PER_M
    profile = [(radius, 0.0), (radius, 0.008), (radius - 0.006, 0.014)]
    x, y, _ = head_base
    made.append(turned(x, y, profile, STEEL))
    mat = (x - 0.2, x + 0.2), (y - 0.22, y + 0.22), (-0.004, 0.003)
    made.append(soft_box(*mat, MAT, 0.03, 0.001))
    return Node("table", merged(made))


def stand_node(stand: Stand, head_base: np.ndarray) -> Node:
    """Return the post under the head; its origin, in the middle of its top, is moved."""
    radius = stand.diameter_mm / 2.0 / MM_PER_M
    bottom = -float(head_base[2]) - INTO_TABLE
    profile = [(radius, bottom), (radius, -0.012), (radius - 0.004, -0.002)]
    return Node("stand", merged([turned(0.0, 0.0, profile, STEEL)]))
