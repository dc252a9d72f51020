"""The axes that "right, forward, up" mean: those of the camera, or those of the robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum

from rastrainer.scenario.scenario import Camera
from rastrainer_simulator.vectors import Vector, cross, length, reject, rotated, scale, unit, vector

WORLD_UP: Vector = (0.0, 0.0, 1.0)


class AxesChoice(str, Enum):
    """Whose right, forward and up the sticks follow."""

    CAMERA = "camera"
    ROBOT = "robot"


@dataclass(frozen=True)
class Axes:
    """Three perpendicular unit vectors in World: where right, forward and up point."""

    right: Vector
    forward: Vector
    up: Vector

    def to_world(self, amounts: tuple[float, float, float]) -> Vector:
        """Return the World vector of a displacement to the right, forward and up."""
        sideways, ahead, above = amounts
        return vector(
            sideways * r + ahead * f + above * u
            for r, f, u in zip(self.right, self.forward, self.up, strict=True)
        )

    def turned(self, turn: float) -> Axes:
        """Return the axes turned about the vertical, counterclockwise from above, by rad."""
        return Axes(
            *(rotated(axis, WORLD_UP, turn) for axis in (self.right, self.forward, self.up))
        )


ROBOT_AXES = Axes(right=(0.0, -1.0, 0.0), forward=(1.0, 0.0, 0.0), up=WORLD_UP)
"""Seen from behind the robot's base: forward is World's x."""


def camera_axes(view_direction: Vector, view_up: Vector) -> Axes:
    """Return a camera's axes, leveled: up is World's up and forward the horizontal view direction.

    A camera that looks straight down or up has no horizontal view direction: its own up in the
    picture takes that part (its down, where it looks up).
    """
    ahead = reject(unit(view_direction), WORLD_UP)
    if length(ahead) < 1e-3:
        ahead = reject(view_up if view_direction[2] < 0.0 else scale(view_up, -1.0), WORLD_UP)
    forward = unit(ahead)
    return Axes(right=cross(forward, WORLD_UP), forward=forward, up=WORLD_UP)


class ChosenAxes:
    """The axes of the chosen camera, and those that the sticks follow.

    Attributes:
        camera: name of the chosen one.
    """

    def __init__(self, cameras: Mapping[str, Camera], camera: str, choice: AxesChoice) -> None:
        self._choice = choice
        self._axes_of_cameras = {
            name: camera_axes(
                tuple((view.focal_point - view.position).tolist()), tuple(view.view_up.tolist())
            )
            for name, view in cameras.items()
        }
        self.camera = camera

    @property
    def of_camera(self) -> Axes:
        """Right, forward and up as the chosen camera sees them."""
        return self._axes_of_cameras[self.camera]

    @property
    def of_sticks(self) -> Axes:
        """Right, forward and up as the sticks mean them."""
        return self.of_camera if self._choice is AxesChoice.CAMERA else ROBOT_AXES
