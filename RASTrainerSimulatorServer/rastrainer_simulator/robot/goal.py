"""Goals for FABRIK in the arm's frame, and its settings and solutions."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, dist, sin, sqrt
from typing import NamedTuple

from rastrainer.errors import InputError
from rastrainer_simulator.robot.branches import Roll
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, Chain, tip
from rastrainer_simulator.vectors import Vector, add, dot, length, scale

OUT_OF_REACH = "The target is out of reach; the tool is as near to it as the arm gets."
ROLL_BLOCKED = (
    "The joint limits do not allow this roll of the tool there; it is as near as it gets."
)
BLOCKED = "No posture inside the joint limits holds the tool like that; the arm does not move."


@dataclass(frozen=True)
class FabrikSettings:
    """When a solution is good enough, and when the passes give up."""

    tolerance_m: float = 1e-9
    tolerance_rad: float = 1e-8
    max_iterations: int = 32

    def __post_init__(self) -> None:
        """Raise InputError for settings that could never end or never succeed."""
        if not (self.tolerance_m > 0.0 and self.tolerance_rad > 0.0 and self.max_iterations >= 1):
            raise InputError("FABRIK needs tolerances above zero and at least one iteration.")

    def met(self, position_error_m: float, direction_error_rad: float) -> bool:
        """Return whether errors are within tolerance."""
        return position_error_m <= self.tolerance_m and direction_error_rad <= self.tolerance_rad


class Solution(NamedTuple):
    """Joint angles (rad) inside the limits, and how far from the target they hold the tool.

    `direction_error_rad` is the angle between the tool's directions, or of the rotation between the
    poses if a rotation was given, or 0. `reason` is a sentence for the operator, empty if the
    target is met.
    """

    q: tuple[float, ...]
    position_error_m: float
    direction_error_rad: float
    converged: bool
    iterations: int
    reason: str


_TINY = 1e-12
_NEAR_M = 0.03
_NEAR_COSINE = 0.95


class Goal(NamedTuple):
    """A position (m), the tool's direction unless it is free, and its roll unless that is free."""

    position: Vector
    tool: Vector | None
    roll: Roll

    @property
    def held_tool(self) -> Vector:
        """The tool's direction, of a goal that has one."""
        assert self.tool is not None
        return self.tool

    def wrist(self, arm: CanonicalArm) -> Vector:
        """Return where a wrist has to be that holds the tool's direction, m."""
        (x, y, z), (tx, ty, tz), size = self.position, self.held_tool, arm.tool
        return x - size * tx, y - size * ty, z - size * tz

    def is_near(self, arm: CanonicalArm, links: Chain) -> bool:
        """Return whether the tool is already almost at the goal, as within a motion."""
        if dist(self.position, tip(arm, links)) > _NEAR_M:
            return False
        return self.tool is None or dot(links[2], self.tool) > _NEAR_COSINE

    def within_lengths(self, arm: CanonicalArm) -> Goal:
        """Return the nearest goal that the lengths of the links and the elbow's tilt allow."""
        if self.tool is None:
            x, y, z = self.position
            square = x * x + y * y + z * z
            if square <= arm.reach * arm.reach:
                return self
            return self._moved(scale(self.position, arm.reach / sqrt(square)))
        wrist = self.wrist(arm)
        far = length(wrist)
        if arm.nearest <= far <= arm.farthest or far < _TINY:
            return self
        held = scale(wrist, (arm.nearest if far < arm.nearest else arm.farthest) / far)
        return self._moved(add(held, scale(self.tool, arm.tool)))

    def _moved(self, position: Vector) -> Goal:
        return Goal(position, self.tool, self.roll)

    def errors(self, arm: CanonicalArm, theta: Angles, links: Chain) -> tuple[float, float]:
        """Return how far θ, whose chain is `links`, is from the goal: m and rad."""
        position_error = dist(self.position, tip(arm, links))
        if self.tool is None:
            return position_error, 0.0
        (x, y, z), cosine = self._turn(theta, links)
        return position_error, atan2(sqrt(x * x + y * y + z * z), cosine)

    def _turn(self, theta: Angles, links: Chain) -> tuple[Vector, float]:
        """Return axis · sine and the cosine of the rotation from θ's tool to the goal's."""
        (ax, ay, az), (bx, by, bz) = links[2], self.held_tool
        x, y, z = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
        cosine = ax * bx + ay * by + az * bz
        if self.roll is None:
            return (x, y, z), cosine
        # From the skew part and the trace: exact for small angles too.
        (ax, ay, az), (cx, cy, cz) = tool_axes(theta, links)
        (bx, by, bz), (dx, dy, dz) = self.roll
        x += ay * bz - az * by + cy * dz - cz * dy
        y += az * bx - ax * bz + cz * dx - cx * dz
        z += ax * by - ay * bx + cx * dy - cy * dx
        trace = cosine + ax * bx + ay * by + az * bz + cx * dx + cy * dy + cz * dz
        return (0.5 * x, 0.5 * y, 0.5 * z), 0.5 * (trace - 1.0)


def tool_axes(theta: Angles, links: Chain) -> tuple[Vector, Vector]:
    """Return the tool's x and y axes."""
    (wx, wy, wz), (tx, ty, tz) = links[5], links[2]
    ax, ay, az = wy * tz - wz * ty, wz * tx - wx * tz, wx * ty - wy * tx
    c, s = cos(theta[6]), sin(theta[6])
    return (
        (c * ax + s * wx, c * ay + s * wy, c * az + s * wz),
        (c * wx - s * ax, c * wy - s * ay, c * wz - s * az),
    )
