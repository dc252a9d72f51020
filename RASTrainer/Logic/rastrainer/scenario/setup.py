"""The set-up of a head at the robot: its pose, the table, the robot's base."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from rastrainer.errors import InputError
from rastrainer.files.reading import MAX_RECORD_BYTES, read_json
from rastrainer.head.trial_head import Perturbation
from rastrainer.json_checks import number, numbers
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import WORLD_LIMIT_MM
from rastrainer.scenario.scenario import Camera, OperatingTable, Stand

FAR_EYE_MM, FAR_FOCUS_MM = (240.0, -2050.0, 1050.0), (240.0, 0.0, 430.0)
CLOSE_UP_FROM_HEAD_MM, FOCUS_FROM_HEAD_MM = (0.0, -600.0, 220.0), (0.0, 0.0, 5.0)
LOWEST_BASE_MM = 20.0
USUAL_PERTURBATION = Perturbation(15.0, 8.0, 3.0)
USUAL_TABLE, USUAL_STAND = OperatingTable((300.0, 0.0), (1300.0, 1000.0, 40.0)), Stand(80.0)


@dataclass(frozen=True)
class HeadPlace:
    """Where the head's center is; yaw 0 faces −y, with the right side toward the robot."""

    center_mm: Annotated[tuple[float, ...], numbers(3, WORLD_LIMIT_MM)] = (480.0, 0.0, 220.0)
    yaw_deg: Annotated[float, number(-180, 180)] = 0.0
    """About the vertical, counterclockwise from above."""


@dataclass(frozen=True)
class SetUp:
    """A set-up, in the table's frame: World of a robot at the default place.

    The perturbation is how far a trial's pose may be from it; the robot's base has x and y on the
    table.
    """

    head: HeadPlace = HeadPlace()
    perturbation: Perturbation = USUAL_PERTURBATION
    table: OperatingTable = USUAL_TABLE
    stand: Stand = USUAL_STAND
    robot_base_mm: Annotated[tuple[float, ...], numbers(2, WORLD_LIMIT_MM)] = (0.0, 0.0)

    @property
    def _base(self) -> np.ndarray:
        return np.array([*self.robot_base_mm, 0.0])

    def head_to_world(self, middle_ras: np.ndarray) -> np.ndarray:
        """Return the nominal pose (4, 4), mm, of a head with its center at (3,) RAS mm."""
        angle = np.radians(180.0 + self.head.yaw_deg)
        c, s = np.cos(angle).round(12), np.sin(angle).round(12)
        pose = np.eye(4)
        pose[:2, :2] = [[c, -s], [s, c]]
        pose[:3, 3] = np.array(self.head.center_mm) - self._base - pose[:3, :3] @ middle_ras
        return pose

    def cameras(self) -> dict[str, Camera]:
        """Return the close-up view of the face and the far view of the robot, World mm."""
        center, up = np.array(self.head.center_mm), np.array([0.0, 0.0, 1.0])
        near = center + CLOSE_UP_FROM_HEAD_MM, center + FOCUS_FROM_HEAD_MM
        far = np.array(FAR_EYE_MM), np.array(FAR_FOCUS_MM)
        return {
            "close-up": Camera(near[0] - self._base, near[1] - self._base, up, 30.0),
            "far": Camera(far[0] - self._base, far[1] - self._base, up, 32.0),
        }

    def table_in_world(self) -> OperatingTable:
        x, y = np.array(self.table.center_mm) - self.robot_base_mm
        return replace(self.table, center_mm=(x, y))

    def check_height(self, lowest_ras: float, middle_ras: np.ndarray) -> None:
        """Check that the head's base is above the table."""
        height = self.head.center_mm[2] - (middle_ras[2] - lowest_ras)
        if height < LOWEST_BASE_MM:
            raise InputError(
                f"The head's base would be {height:.0f} mm above the table; it must be at least "
                f"{LOWEST_BASE_MM:g} mm: cut the head higher, or set it up higher."
            )


def read_setup(path: Path) -> SetUp:
    """Read a set-up from a JSON file; missing fields have defaults."""
    given = read_json(path, MAX_RECORD_BYTES)
    values = {**record_to_json(SetUp(), with_defaults=True)}
    if not isinstance(given, dict):
        raise InputError(f"{path} must be a JSON object.")
    for name, value in given.items():
        is_nested = isinstance(value, dict) and isinstance(values.get(name), dict)
        values[name] = {**values[name], **value} if is_nested else value
    return record_from_json(SetUp, values, str(path), only_known=True)
