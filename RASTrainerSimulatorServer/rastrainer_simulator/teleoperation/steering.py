"""How the sticks steer: whose right, forward and up they follow, and the direction of the tool."""

from __future__ import annotations

import math
from dataclasses import dataclass
from enum import Enum

from rastrainer.json_checks import Setting
from rastrainer.scenario.scenario import Camera
from rastrainer_simulator.vectors import (
    ZERO,
    Vector,
    add,
    angle,
    cross,
    length,
    parallel_transport,
    reject,
    rotated,
    scale,
    turned_toward,
    unit,
    vector,
)

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


def axes_of(camera: Camera) -> Axes:
    direction = vector((camera.focal_point_mm - camera.position_mm).tolist())
    return camera_axes(direction, vector(camera.view_up.tolist()))


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


class ToolDirection(str, Enum):
    """The ways to choose the tool's direction.

    FREE: by the inverse kinematics alone, as in the paper. CLEAR: the same, but near the head the
    tool leans no farther from the surface normal than keeps its shaft off the skin. HELD: it stays
    as it is until the second stick turns it. NORMAL: as HELD, but near the head it comes down along
    the surface normal. POSE: as HELD, and the tool does not roll about its axis either.
    """

    FREE = "free"
    CLEAR = "clear"
    HELD = "held"
    NORMAL = "normal"
    POSE = "pose"


@dataclass(frozen=True)
class SteeringSettings:
    """How the tool's direction is steered; lengths in m, angles in rad.

    Attributes:
        coarse_turn, fine_turn: fastest turn by the stick, without and with the trigger, rad/s.
        leaning_turn: fastest turn toward the surface normal, rad/s.
        largest_lean: of CLEAR, between the tool and the normal, up to the clearance `near`.
        far: clearance from which the lean is not limited.
        shaft_clearance: clearance of the shaft below which the tool turns away.
        from_above: least downward part of the direction toward which the tool leans, 0…1: coming
            from below, the wrist would be at the table.
    """

    choice: ToolDirection = ToolDirection.CLEAR
    coarse_turn: Setting = 0.8
    fine_turn: Setting = 0.15
    leaning_turn: Setting = 2.0
    largest_lean: Setting = math.pi / 4
    near: Setting = 0.01
    far: Setting = 0.12
    shaft_clearance: Setting = 0.001
    from_above: Setting = 0.3


@dataclass(frozen=True)
class NearestSurface:
    """Clearances (m) of the tip and the shaft behind it, and the head's outward normals there."""

    clearance: float
    normal: Vector
    shaft_clearance: float
    shaft_normal: Vector


class ToolSteering:
    """Stores the wanted direction of the tool."""

    def __init__(self, settings: SteeringSettings) -> None:
        self._settings = settings
        self._has_to_hold = False
        self.hold_direction(is_held=False)
        self.reset()

    def hold_direction(self, is_held: bool) -> None:
        """Have the operator hold and steer the tool's direction, or follow the settings."""
        self._choice = ToolDirection.HELD if is_held else self._settings.choice
        self.is_steered = self._choice not in (ToolDirection.FREE, ToolDirection.CLEAR)
        if is_held is not self._has_to_hold:
            self._has_to_hold = is_held
            self.reset()

    def reset(self) -> None:
        """Forget the held direction: the next motion keeps the tool's direction."""
        self._held: Vector | None = None
        # The tool's direction and x axis by which its roll is held.
        self._frame: tuple[Vector, Vector] | None = None

    def across(self, wanted: Vector, direction: Vector, across: Vector) -> Vector | None:
        """Return the wanted x axis of the tool along `wanted`, None if its roll is free.

        `direction` and `across` are the tool's direction and x axis now.
        """
        if self._choice is not ToolDirection.POSE:
            return None
        before, held = self._frame or (direction, across)
        self._frame = (wanted, parallel_transport(held, before, wanted))
        return self._frame[1]

    def turn_to(self, direction: Vector, goal: Vector, dt: float) -> Vector:
        self._held = turned_toward(direction, goal, self._settings.coarse_turn * dt)
        return self._held

    def steer(
        self,
        dt: float,
        turn: tuple[float, float],
        fine: bool,
        axes: Axes,
        direction: Vector,
        surface: NearestSurface | None,
    ) -> Vector | None:
        """Return the wanted direction of the tool after this tick, None if it is free.

        `turn` is the steering stick's response (right, up), `direction` the tool's direction now,
        `surface` the head near the tool, if any.
        """
        settings = self._settings
        if turn != (0.0, 0.0):
            fastest = settings.fine_turn if fine else settings.coarse_turn
            self._held = _turned(direction, turn, fastest * dt, axes)
            return self._held
        leaned = self._leaned(dt, direction, surface) if surface else None
        if not self.is_steered:
            return leaned
        self._held = leaned or self._held or direction
        return self._held

    def _leaned(self, dt: float, direction: Vector, surface: NearestSurface) -> Vector | None:
        """Return the direction turned toward the normal, None if it may stay."""
        settings = self._settings
        if self._choice not in (ToolDirection.CLEAR, ToolDirection.NORMAL):
            return None
        most = settings.leaning_turn * dt
        if surface.shaft_clearance < min(settings.shaft_clearance, surface.clearance):
            return turned_toward(direction, scale(surface.shaft_normal, -1.0), most)
        x, y, z = surface.normal
        inward = unit((-x, -y, -max(z, settings.from_above)))
        lean = settings.largest_lean if self._choice is ToolDirection.CLEAR else 0.0
        share = (surface.clearance - settings.near) / (settings.far - settings.near)
        limit = math.pi
        if share < 1.0:
            limit = lean + (0.5 * math.pi - lean) * min(max(share, 0.0), 1.0)
        excess = angle(direction, inward) - limit
        return turned_toward(direction, inward, min(excess, most)) if excess > 0.0 else None


def _turned(direction: Vector, turn: tuple[float, float], most: float, axes: Axes) -> Vector:
    """Swing the tip to the right and pitch it upward, as a stick pushed right and up does."""
    to_the_right = cross(direction, unit(reject(axes.right, direction)))
    spin = add(scale(to_the_right, turn[0]), scale(axes.right, turn[1]) if turn[1] != 0.0 else ZERO)
    size = length(spin)
    return unit(rotated(direction, scale(spin, 1.0 / size), size * most)) if size else direction
