"""Where the tool shall point: free as in the paper, held and steered, or along the normal."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from rastrainer_simulator.teleoperation.axes import Axes
from rastrainer_simulator.vectors import (
    ZERO,
    Vector,
    add,
    cross,
    length,
    reject,
    rotated,
    scale,
    turned_toward,
    unit,
)


class ToolDirection(str, Enum):
    """Who decides the tool's direction.

    FREE: the inverse kinematics, as in the paper: only the tip's position is followed.
    HELD: the operator: it stays as it is until the second stick turns it.
    NORMAL: near the head the skin: the tool comes down along the surface normal; else as HELD.
    """

    FREE = "free"
    HELD = "held"
    NORMAL = "normal"


@dataclass(frozen=True)
class SteeringSettings:
    """How the tool's direction is steered.

    Attributes:
        choice: who decides the direction.
        coarse_turn: fastest turn in rad/s.
        fine_turn: fastest turn in rad/s while the trigger for fine speed is held.
        normal_distance: clearance in m below which NORMAL turns the tool along the surface normal.
    """

    choice: ToolDirection = ToolDirection.FREE
    coarse_turn: float = 0.8
    fine_turn: float = 0.15
    normal_distance: float = 0.06


@dataclass(frozen=True)
class Surface:
    """The head as the tip sees it: its clearance (m) and the outward normal nearest to it."""

    clearance: float
    normal: Vector


class ToolSteering:
    """Keeps the direction that the tool shall have."""

    def __init__(self, settings: SteeringSettings) -> None:
        self._settings = settings
        self._held: Vector | None = None

    @property
    def is_steered(self) -> bool:
        """Whether the steering stick has a say."""
        return self._settings.choice is not ToolDirection.FREE

    def reset(self) -> None:
        """Forget the held direction: the tool keeps the one it has when it is next moved."""
        self._held = None

    def turn_to(self, direction: Vector, goal: Vector, dt: float) -> Vector:
        """Return the direction for a move that is to end with the tool along `goal`."""
        self._held = turned_toward(direction, goal, self._settings.coarse_turn * dt)
        return self._held

    def steer(
        self,
        dt: float,
        turn: tuple[float, float],
        fine: bool,
        axes: Axes,
        direction: Vector,
        surface: Surface | None,
    ) -> Vector | None:
        """Return the direction that the tool shall have after this tick, None where it is free.

        `turn` is the steering stick's response (right, up), `direction` the tool's direction now,
        `surface` the head near the tip, if any.
        """
        settings = self._settings
        if not self.is_steered:
            self._held = None
            return None
        held = self._held or direction
        fastest = settings.fine_turn if fine else settings.coarse_turn
        if turn != (0.0, 0.0):
            held = _turned(direction, turn, fastest * dt, axes)
        elif (
            settings.choice is ToolDirection.NORMAL
            and surface is not None
            and surface.clearance < settings.normal_distance
        ):
            held = turned_toward(direction, scale(surface.normal, -1.0), fastest * dt)
        self._held = held
        return held


def _turned(direction: Vector, turn: tuple[float, float], most: float, axes: Axes) -> Vector:
    """Swing the tip to the right and pitch it upward: what a stick pushed that way shows."""
    to_the_right = cross(direction, unit(reject(axes.right, direction)))
    spin = add(scale(to_the_right, turn[0]), scale(axes.right, turn[1]) if turn[1] != 0.0 else ZERO)
    size = length(spin)
    return unit(rotated(direction, scale(spin, 1.0 / size), size * most)) if size else direction
