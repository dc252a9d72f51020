"""The room around the robot: floor, wall, table and the stand that holds the head."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkCylinderSource
from vtkmodules.vtkRenderingCore import vtkActor

from rastrainer.scenario import Furniture
from rastrainer_simulator.views.actors import actor
from rastrainer_simulator.views.head_actors import ShownHead
from rastrainer_simulator.views.materials import (
    FLOOR,
    MAT,
    STEEL,
    TABLE_TOP,
    WALL,
    WALL_BAND,
    Material,
)

MM_IN_M = 1000.0
LEG_RADIUS = 0.025
LEG_INSET = 0.08
FLOOR_HEIGHT = -0.78
ROOM = ((-2.6, 3.2), (-3.2, 1.9))
WALL_TOP = 1.9
WALL_BAND_HEIGHTS = (-0.02, 0.16)


def room(furniture: Furniture) -> list[vtkActor]:
    """Return floor, walls and table; the table's top is the plane z = 0 of World."""
    width, depth, thickness = furniture.table_size / MM_IN_M
    x, y = furniture.table_center / MM_IN_M
    left, right, near, far = x - width / 2, x + width / 2, y - depth / 2, y + depth / 2
    legs = [
        _post(leg_x, leg_y, FLOOR_HEIGHT, -thickness, LEG_RADIUS)
        for leg_x in (left + LEG_INSET, right - LEG_INSET)
        for leg_y in (near + LEG_INSET, far - LEG_INSET)
    ]
    table = _box((left, right), (near, far), (-thickness, 0.0), TABLE_TOP)
    return [table, *legs, *_walls()]


def _walls() -> list[vtkActor]:
    """Return the floor and four walls with a colored band and skirting; there is no ceiling."""
    (left, right), (near, far) = ROOM
    bands = ((*WALL_BAND_HEIGHTS, WALL_BAND), (FLOOR_HEIGHT, FLOOR_HEIGHT + 0.1, WALL_BAND))
    made = [_box((left, right), (near, far), (FLOOR_HEIGHT - 0.01, FLOOR_HEIGHT), FLOOR)]
    for low, high, material in ((FLOOR_HEIGHT, WALL_TOP, WALL), *bands):
        out = 0.0 if material is WALL else 0.002
        for x in ((left - 0.1, left + out), (right - out, right + 0.1)):
            made.append(_box(x, (near, far), (low, high), material))
        for y in ((near - 0.1, near + out), (far - out, far + 0.1)):
            made.append(_box((left, right), y, (low, high), material))
    return made


def head_stand(head: ShownHead, furniture: Furniture) -> list[vtkActor]:
    """Return the post under a head, its foot, and the mat on which they stand."""
    x, y, top = head.base_in_world()
    radius = furniture.stand_diameter / 2.0 / MM_IN_M
    return [
        _post(x, y, 0.0, top - 0.001, radius),
        _post(x, y, 0.0, 0.01, 1.8 * radius),
        _box((x - 0.2, x + 0.2), (y - 0.22, y + 0.22), (0.0, 0.003), MAT),
    ]


def _box(
    x: tuple[float, float], y: tuple[float, float], z: tuple[float, float], material: Material
) -> vtkActor:
    cube = vtkCubeSource()
    cube.SetBounds(*x, *y, *z)
    cube.Update()
    return actor(cube.GetOutput(), material)


def _post(x: float, y: float, bottom: float, top: float, radius: float) -> vtkActor:
    """Return an upright steel cylinder."""
    cylinder = vtkCylinderSource()
    cylinder.SetRadius(radius)
    cylinder.SetHeight(top - bottom)
    cylinder.SetResolution(64)
    cylinder.Update()
    upright = np.array([[1, 0, 0, x], [0, 0, -1, y], [0, 1, 0, (top + bottom) / 2], [0, 0, 0, 1]])
    return actor(cylinder.GetOutput(), STEEL, upright)
