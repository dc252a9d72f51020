"""The room around the robot: floor, wall, table and the stand that holds the head."""

from __future__ import annotations

import numpy as np
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkCylinderSource
from vtkmodules.vtkRenderingCore import vtkActor

from rastrainer_simulator.views.actors import actor
from rastrainer_simulator.views.materials import (
    FLOOR,
    MAT,
    STEEL,
    TABLE_TOP,
    WALL,
    WALL_BAND,
    Material,
)

TABLE = ((-0.45, 1.05), (-0.60, 0.60))
TABLE_THICKNESS = 0.04
FLOOR_HEIGHT = -0.78
ROOM = ((-2.6, 3.2), (-3.2, 1.9))
WALL_TOP = 1.9
WALL_BAND_HEIGHTS = (-0.02, 0.16)
PLATE_RADIUS = 0.075
PLATE_THICKNESS = 0.012


def room() -> list[vtkActor]:
    """Return floor, wall and table; the table's top is the plane z = 0 of World."""
    (left, right), (near, far) = TABLE
    legs = [
        _post(x, y, FLOOR_HEIGHT, -TABLE_THICKNESS, 0.025)
        for x in (left + 0.08, right - 0.08)
        for y in (near + 0.08, far - 0.08)
    ]
    table = _box((left, right), (near, far), (-TABLE_THICKNESS, 0.0), TABLE_TOP)
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


def head_stand(head_vertices: np.ndarray, head_to_world: np.ndarray) -> list[vtkActor]:
    """Return plate and post under a head, and the mat on which they stand.

    `head_vertices` (n, 3) float and `head_to_world` (4, 4) float are in metres. The plate lies
    under the head's flat base, however the head is posed.
    """
    lowest = head_vertices[:, 2].min()
    base = head_vertices[head_vertices[:, 2] < lowest + 0.002]
    middle = np.append((base.min(axis=0) + base.max(axis=0))[:2] / 2, lowest)
    pose = head_to_world.copy()
    pose[:3, 3] = head_to_world[:3, :3] @ middle + head_to_world[:3, 3]
    x, y, top = pose[:3, 3] - pose[:3, 2] * PLATE_THICKNESS
    return [
        _upright_cylinder(PLATE_RADIUS, -PLATE_THICKNESS, -0.0005, STEEL, pose),
        _post(x, y, 0.0, top + 0.002, 0.018),
        _post(x, y, 0.0, 0.014, 0.09),
        _box((x - 0.21, x + 0.21), (y - 0.24, y + 0.24), (0.0, 0.003), MAT),
    ]


def _box(
    x: tuple[float, float], y: tuple[float, float], z: tuple[float, float], material: Material
) -> vtkActor:
    cube = vtkCubeSource()
    cube.SetBounds(*x, *y, *z)
    cube.Update()
    return actor(cube.GetOutput(), material)


def _post(x: float, y: float, bottom: float, top: float, radius: float) -> vtkActor:
    pose = np.eye(4)
    pose[:2, 3] = x, y
    return _upright_cylinder(radius, bottom, top, STEEL, pose)


def _upright_cylinder(
    radius: float, bottom: float, top: float, material: Material, pose: np.ndarray
) -> vtkActor:
    cylinder = vtkCylinderSource()
    cylinder.SetRadius(radius)
    cylinder.SetHeight(top - bottom)
    cylinder.SetResolution(64)
    cylinder.Update()
    upright = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, (top + bottom) / 2], [0, 0, 0, 1]])
    return actor(cylinder.GetOutput(), material, pose @ upright)
