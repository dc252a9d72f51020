"""The set-up of a head at the robot: its pose, the table, the robot's base."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.json_fields import json_object, read_fields
from rastrainer.files.writing import write_json
from rastrainer.head.trial_head import Perturbation
from rastrainer.protocol import WORLD_LIMIT_MM
from rastrainer.scenario.scenario import STAND_DIAMETERS_MM, Camera, Furniture, read_perturbation

FAR_EYE_MM, FAR_FOCUS_MM = (240.0, -2050.0, 1050.0), (240.0, 0.0, 430.0)
CLOSE_UP_FROM_HEAD_MM, FOCUS_FROM_HEAD_MM = (0.0, -600.0, 220.0), (0.0, 0.0, 5.0)
LOWEST_BASE_MM = 20.0


@dataclass(frozen=True)
class SetUp:
    """A set-up; lengths in mm, in the table's frame: World of a robot at the default place.

    Attributes:
        head_yaw_deg: rotation about the vertical, counterclockwise from above; 0 faces −y, with the
            right side toward the robot.
        perturbation: how far a trial's pose may be from it.
        table_center: x and y.
        table_size: along x, along y, thickness.
        stand_diameter: of the head's stand.
        robot_base: x and y of the robot's base on the table.
    """

    head_center: tuple[float, ...] = (480.0, 0.0, 220.0)
    head_yaw_deg: float = 0.0
    perturbation: Perturbation = field(default_factory=lambda: Perturbation(15.0, 8.0, 3.0))
    table_center: tuple[float, ...] = (300.0, 0.0)
    table_size: tuple[float, ...] = (1300.0, 1000.0, 40.0)
    stand_diameter: float = 80.0
    robot_base: tuple[float, ...] = (0.0, 0.0)

    @property
    def _base(self) -> np.ndarray:
        return np.array([*self.robot_base, 0.0])

    def head_to_world(self, middle_ras: np.ndarray) -> np.ndarray:
        """Return the nominal pose (4, 4), mm, of a head with its center at (3,) RAS mm."""
        angle = np.radians(180.0 + self.head_yaw_deg)
        c, s = np.cos(angle).round(12), np.sin(angle).round(12)
        pose = np.eye(4)
        pose[:2, :2] = [[c, -s], [s, c]]
        pose[:3, 3] = np.array(self.head_center) - self._base - pose[:3, :3] @ middle_ras
        return pose

    def cameras(self) -> dict[str, Camera]:
        """Return the close-up view of the face and the far view of the robot, World mm."""
        center, up = np.array(self.head_center), np.array([0.0, 0.0, 1.0])
        near = center + CLOSE_UP_FROM_HEAD_MM, center + FOCUS_FROM_HEAD_MM
        far = np.array(FAR_EYE_MM), np.array(FAR_FOCUS_MM)
        return {
            "close-up": Camera(near[0] - self._base, near[1] - self._base, up, 30.0),
            "far": Camera(far[0] - self._base, far[1] - self._base, up, 32.0),
        }

    def furniture(self) -> Furniture:
        """Return table and stand, World mm."""
        center = np.array(self.table_center) - self.robot_base
        return Furniture(center, np.array(self.table_size), self.stand_diameter)

    def check_height(self, lowest_ras: float, middle_ras: np.ndarray) -> None:
        """Check that the head's base is above the table."""
        height = self.head_center[2] - (middle_ras[2] - lowest_ras)
        if height < LOWEST_BASE_MM:
            raise InputError(
                f"The head's base would be {height:.0f} mm above the table; it must be at least "
                f"{LOWEST_BASE_MM:g} mm: cut the head higher, or set it up higher."
            )


def read_setup(path: Path) -> SetUp:
    """Read a set-up from a JSON file; missing fields have defaults."""
    fields = read_fields(Path(path))
    known = ("head", "perturbation", "table", "stand", "robotBaseMm")
    unknown = [name for name in fields.names() if name not in known]
    if unknown:
        raise InputError(f"{path}: a set-up has no {unknown[0]!r}; it has {', '.join(known)}.")
    fields = fields.with_defaults(_content(SetUp()))
    head, table = fields.fields("head"), fields.fields("table")
    return SetUp(
        tuple(head.numbers("centerMm", 3, WORLD_LIMIT_MM)),
        head.number("yawDeg", -180.0, 180.0),
        read_perturbation(fields),
        tuple(table.numbers("centerMm", 2, WORLD_LIMIT_MM)),
        tuple(table.numbers("sizeMm", 3, WORLD_LIMIT_MM)),
        fields.fields("stand").number("diameterMm", *STAND_DIAMETERS_MM),
        tuple(fields.numbers("robotBaseMm", 2, WORLD_LIMIT_MM)),
    )


def write_setup(path: Path, setup: SetUp) -> None:
    """Write a set-up for `read_setup`."""
    write_json(path, _content(setup))


def _content(setup: SetUp) -> dict[str, Any]:
    return {
        "head": {"centerMm": setup.head_center, "yawDeg": setup.head_yaw_deg},
        "perturbation": json_object(setup.perturbation),
        "table": {"centerMm": setup.table_center, "sizeMm": setup.table_size},
        "stand": {"diameterMm": setup.stand_diameter},
        "robotBaseMm": setup.robot_base,
    }
