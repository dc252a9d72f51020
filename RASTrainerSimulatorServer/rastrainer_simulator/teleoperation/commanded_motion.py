"""Motions that a command starts: a jog, and a move to a position."""

from __future__ import annotations

import math
from collections.abc import Iterable
from enum import Enum

from rastrainer.commands import CommandName
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.state import Motion, OperatorCommand
from rastrainer_simulator.teleoperation.steering import Axes
from rastrainer_simulator.vectors import (
    Vector,
    accelerated,
    angle,
    distance,
    length,
    scale,
    shortened,
    subtract,
    unit,
)

ARRIVED = 1e-6
"""A position (m) or direction (rad) this near counts as reached."""
STALLED_AFTER = 0.3
"""s without progress after which a move ends."""
NEAR = 1e-4
"""m: a move that ends within this distance has reached its target."""
PROGRESS = 1e-5
"""m or rad that count as getting nearer."""


class MotionOutcome(str, Enum):
    """How a commanded motion ended."""

    REACHED = "reached"
    BLOCKED = "blocked"
    OVERRIDDEN = "overridden"
    STOPPED = "stopped"


class Jogging:
    """Moves the tip with `velocity` (m/s, World) for `duration` (s)."""

    motion = Motion.JOG
    direction = None
    goal = None

    def __init__(self, velocity: Vector, duration: float) -> None:
        self._velocity = velocity
        self._remaining = duration

    def displacement(
        self, dt: float, _tip: Vector, velocity: Vector, acceleration: float
    ) -> Vector:
        """Return this tick's displacement (m) from the velocity of the last tick (m/s)."""
        time = min(dt, self._remaining)
        self._remaining -= dt
        return scale(accelerated(velocity, self._velocity, acceleration * dt), time)

    def outcome(self, dt: float, _tip: Vector, _direction: Vector) -> MotionOutcome | None:
        """Return how the motion has ended, or None while it lasts."""
        return MotionOutcome.REACHED if self._remaining <= 1e-3 * dt else None


class Moving:
    """Moves the tip to `goal` (m, World) at `speed` (m/s), and brakes so as to stop there.

    The tool is turned to `direction`, the unit vector from A7 to the tip, in World; None leaves it
    as it is.
    """

    motion = Motion.MOVE

    def __init__(self, goal: Vector, speed: float, direction: Vector | None = None) -> None:
        self.goal = goal
        self.direction = direction
        self._speed = speed
        self._nearest = math.inf
        self._stalled = 0.0

    def displacement(self, dt: float, tip: Vector, velocity: Vector, acceleration: float) -> Vector:
        remaining = subtract(self.goal, tip)
        braking_speed = math.sqrt(2.0 * acceleration * length(remaining))
        wanted = scale(unit(remaining), min(self._speed, braking_speed))
        step = scale(accelerated(velocity, wanted, acceleration * dt), dt)
        return shortened(remaining, length(step)) if braking_speed < self._speed else step

    def outcome(self, dt: float, tip: Vector, direction: Vector) -> MotionOutcome | None:
        remaining = distance(tip, self.goal)
        turn = angle(direction, self.direction) if self.direction else 0.0
        if remaining <= ARRIVED and turn <= ARRIVED:
            return MotionOutcome.REACHED
        if remaining + turn < self._nearest - PROGRESS:
            self._nearest = remaining + turn
            self._stalled = 0.0
        else:
            self._stalled += dt
        if self._stalled < STALLED_AFTER:
            return None
        is_there = remaining <= NEAR and turn <= ARRIVED
        return MotionOutcome.REACHED if is_there else MotionOutcome.BLOCKED


VIA = 1e-3
"""m: a waypoint this near is passed; the direction of the tool does not matter."""


Waypoint = tuple[Vector, float, Vector]
"""A goal, the speed toward it and the direction of the tool there, as of `Moving`."""


class FollowingPath(Moving):
    """Moves the tip along waypoints; only the last one has to be reached exactly.

    Only the alignment of the guide has a path.
    """

    motion = Motion.ALIGN

    def __init__(self, waypoints: Iterable[Waypoint]) -> None:
        first, *self._following = waypoints
        super().__init__(*first)

    def outcome(self, dt: float, tip: Vector, direction: Vector) -> MotionOutcome | None:
        if self._following and distance(tip, self.goal) <= VIA:
            super().__init__(*self._following.pop(0))
            return None
        return super().outcome(dt, tip, direction)


CommandedMotion = Jogging | Moving


def commanded_motion(command: OperatorCommand, camera: Axes, tool: Axes) -> CommandedMotion:
    """Return the motion of a Jog or MoveTipTo command.

    The frame "camera" is right, forward and up as the camera sees them, "tool" the axes of the
    tool's tip; both as they are when the command arrives.
    """
    arguments = command.arguments
    if command.name == CommandName.JOG:
        velocity = scale(arguments["velocityMmS"], 1.0 / MM_PER_M)
        axes = {"camera": camera, "tool": tool}.get(arguments["frame"])
        velocity = axes.to_world(velocity) if axes else velocity
        return Jogging(velocity, arguments["durationS"])
    pointed = arguments["direction"]
    return Moving(
        goal=scale(arguments["positionMm"], 1.0 / MM_PER_M),
        speed=arguments["speedMmS"] / MM_PER_M,
        direction=unit(pointed) if pointed and length(pointed) >= 1e-9 else None,
    )
