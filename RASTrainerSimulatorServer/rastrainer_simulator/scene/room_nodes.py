"""The room, the robot's table, and the stand that holds the head."""

from __future__ import annotations

import numpy as np

from rastrainer.scenario.scenario import OperatingTable, Stand
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.scene.nodes import (
    CABINET,
    DARK,
    DISPLAY,
    DOOR,
    FLOOR,
    FLOOR_BORDER,
    LAMP_GLASS,
    MAT,
    STEEL,
    TABLE_TOP,
    TRACE,
    WALL,
    WALL_BAND,
    WALL_SEAM,
    Material,
    Node,
    Surface,
    merged,
)
from rastrainer_simulator.scene.surfaces import Span, box, post, soft_box, turned

FLOOR_HEIGHT = -0.78
WALL_TOP = 1.9
X: Span = (-2.6, 3.2)
Y: Span = (-3.2, 1.9)
WALL_BAND_HEIGHTS = (-0.02, 0.16)
SKIRTING = 0.1
PANEL_WIDTH = 1.15
WALL_THICKNESS = 0.1
SEAM = 0.01
LAMP = ((1.5, 0.85, 0.98), (1.9, 0.95, 1.25))
LAMP_TILT = 0.5


def room_nodes() -> list[Node]:
    """Return floor and room; there is no ceiling, for daylight comes from above."""
    furnishing = [*_walls(), *_door(), *_cart(), *_cabinet()]
    for place in LAMP:
        furnishing.extend(_lamp(*place))
    border = 0.35
    inner = (X[0] + border, X[1] - border), (Y[0] + border, Y[1] - border)
    floor = [
        box(X, Y, (FLOOR_HEIGHT - 0.02, FLOOR_HEIGHT - 0.001), FLOOR_BORDER),
        box(*inner, (FLOOR_HEIGHT - 0.01, FLOOR_HEIGHT), FLOOR),
    ]
    return [Node("floor", merged(floor)), Node("room", merged(furnishing))]


def _walls() -> list[Surface]:
    """Return four walls of panels, with a colored band and a skirting."""
    made = _around((FLOOR_HEIGHT, WALL_TOP), 0.0, WALL)
    made += _around(WALL_BAND_HEIGHTS, 0.002, WALL_BAND)
    made += _around((FLOOR_HEIGHT, FLOOR_HEIGHT + SKIRTING), 0.006, WALL_BAND)
    height = (FLOOR_HEIGHT + SKIRTING, WALL_TOP)
    for x in np.arange(X[0] + PANEL_WIDTH, X[1], PANEL_WIDTH):
        for y in Y:
            made.append(box((x, x + SEAM), (y - SEAM / 2, y + SEAM / 2), height, WALL_SEAM))
    for y in np.arange(Y[0] + PANEL_WIDTH, Y[1], PANEL_WIDTH):
        for x in X:
            made.append(box((x - SEAM / 2, x + SEAM / 2), (y, y + SEAM), height, WALL_SEAM))
    return made


def _around(height: Span, out: float, material: Material) -> list[Surface]:
    """Return a strip along all four walls that projects by `out`."""
    made = []
    for x in ((X[0] - WALL_THICKNESS, X[0] + out), (X[1] - out, X[1] + WALL_THICKNESS)):
        made.append(box(x, Y, height, material))
    for y in ((Y[0] - WALL_THICKNESS, Y[0] + out), (Y[1] - out, Y[1] + WALL_THICKNESS)):
        made.append(box(X, y, height, material))
    return made


def _door() -> list[Surface]:
    """Return a double sliding door with two windows in the far wall."""
    y, top = Y[1], 1.32
    made = [soft_box((-2.36, -0.94), (y - 0.04, y), (FLOOR_HEIGHT, top + 0.07), STEEL, 0.015)]
    for left in (-2.29, -1.645):
        right = left + 0.635
        made.append(
            soft_box((left, right), (y - 0.055, y), (FLOOR_HEIGHT + 0.005, top), DOOR, 0.01)
        )
        window = ((left + 0.2, right - 0.2), (y - 0.06, y), (0.35, 1.05))
        made.append(soft_box(*window, DARK, 0.01))
    made.append(soft_box((-1.74, -1.71), (y - 0.09, y - 0.05), (0.0, 0.42), STEEL, 0.012))
    made.append(soft_box((-1.60, -1.57), (y - 0.09, y - 0.05), (0.0, 0.42), STEEL, 0.012))
    return made


def _cart() -> list[Surface]:
    """Return a cart with drawers and a monitor, behind the robot."""
    x, y, low, top = (-0.86, -0.3), (1.2, 1.68), FLOOR_HEIGHT + 0.1, 0.14
    made = [
        soft_box(x, y, (low, top), CABINET, 0.03),
        soft_box((x[0] - 0.02, x[1] + 0.02), (y[0] - 0.02, y[1] + 0.02), (top, top + 0.03), STEEL),
    ]
    for row in range(4):
        bottom = low + 0.04 + 0.19 * row
        front = (y[0] - 0.012, y[0] + 0.02)
        made.append(
            soft_box((x[0] + 0.03, x[1] - 0.03), front, (bottom, bottom + 0.17), WALL, 0.008)
        )
        grip = (y[0] - 0.03, y[0] - 0.01)
        made.append(
            soft_box((-0.68, -0.48), grip, (bottom + 0.12, bottom + 0.135), STEEL, 0.007, 0.003)
        )
    for wheel_x in (x[0] + 0.06, x[1] - 0.06):
        for wheel_y in (y[0] + 0.06, y[1] - 0.06):
            made.append(post(wheel_x, wheel_y, (FLOOR_HEIGHT, low), 0.035, DARK))
    made.append(post(-0.58, 1.5, (top + 0.03, 0.36), 0.022, STEEL))
    made += _monitor((-0.86, -0.3), 1.42, (0.34, 0.70))
    return made


def _monitor(x: Span, y: float, z: Span) -> list[Surface]:
    """Return a monitor that faces −y and shows quiet lines."""
    edge = 0.018
    face_x, face_z = (x[0] + edge, x[1] - edge), (z[0] + edge, z[1] - edge)
    made = [
        soft_box(x, (y, y + 0.045), z, DARK, 0.012),
        box(face_x, (y - 0.001, y + 0.01), face_z, DISPLAY),
    ]
    width, height = face_x[1] - face_x[0], face_z[1] - face_z[0]
    for row in range(3):
        middle = face_z[0] + height * (0.24 + 0.26 * row)
        made += _trace(face_x[0] + 0.06 * width, 0.88 * width, y - 0.002, middle, 0.09 * height)
    return made


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


def _cabinet() -> list[Surface]:
    """Return a tall cabinet with two doors at the far wall."""
    x, y, z = (1.75, 2.85), (1.5, 1.88), (FLOOR_HEIGHT + 0.06, 1.1)
    made = [
        box((x[0] + 0.03, x[1] - 0.03), (y[0] + 0.04, y[1]), (FLOOR_HEIGHT, z[0]), DARK),
        soft_box(x, y, z, CABINET, 0.012),
    ]
    middle = (x[0] + x[1]) / 2.0
    for door in ((x[0] + 0.012, middle - 0.003), (middle + 0.003, x[1] - 0.012)):
        for low, high in ((z[0] + 0.012, 0.1), (0.11, z[1] - 0.012)):
            made.append(soft_box(door, (y[0] - 0.016, y[0] + 0.01), (low, high), WALL, 0.008))
    for grip in (middle - 0.05, middle + 0.035):
        for low in (-0.12, 0.18):
            made.append(
                soft_box((grip, grip + 0.015), (y[0] - 0.04, y[0]), (low, low + 0.16), STEEL, 0.006)
            )
    return made


def _lamp(x: float, y: float, z: float) -> list[Surface]:
    """Return a surgical lamp that hangs from above and is tilted to the table."""
    cosine, sine = np.cos(LAMP_TILT), np.sin(LAMP_TILT)
    pose = np.eye(4)
    pose[:3, :3] = [[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]]
    pose[:3, 3] = x, y, z
    shell = [(0.24, 0.0), (0.30, 0.012), (0.31, 0.04), (0.27, 0.085), (0.14, 0.12), (0.05, 0.13)]
    top = np.array([x, y, z]) + pose[:3, :3] @ [0.0, 0.0, 0.13]
    return [
        turned(0.0, 0.0, shell, CABINET, pose),
        turned(0.0, 0.0, [(0.22, -0.004), (0.22, 0.002)], LAMP_GLASS, pose),
        post(top[0], top[1], (top[2] - 0.03, WALL_TOP), 0.022, STEEL),
    ]


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
