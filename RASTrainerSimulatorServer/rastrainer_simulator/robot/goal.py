"""Queries and answers of FABRIK: goals and θ in the arm's frame, from World and q and back."""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, cos, dist, sin, sqrt
from typing import Annotated, NamedTuple

from rastrainer.errors import InputError
from rastrainer.json_checks import Setting, whole_number
from rastrainer_simulator.robot.closure import Roll
from rastrainer_simulator.robot.srs_arm import Angles, CanonicalArm, Chain, tip
from rastrainer_simulator.vectors import Vector, add, length, scale

OUT_OF_REACH = "The target is out of reach; the tool is as close to it as the arm can bring it."
ROLL_BLOCKED = (
    "The joint limits do not allow this roll of the tool there; it is as close as they allow."
)
BLOCKED = "No posture inside the joint limits holds the tool like that; the arm does not move."


@dataclass(frozen=True)
class FabrikSettings:
    """When a solution is good enough, and when the passes stop."""

    tolerance_m: Setting = 1e-9
    tolerance_rad: Setting = 1e-8
    max_iterations: Annotated[int, whole_number(1, 10_000)] = 32

    def __post_init__(self) -> None:
        if not (self.tolerance_m > 0.0 and self.tolerance_rad > 0.0 and self.max_iterations >= 1):
            raise InputError("FABRIK needs tolerances above zero and at least one iteration.")


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
    reason: str


_TINY = 1e-12


class Goal(NamedTuple):
    """A position (m), the tool's direction unless it is free, and its roll unless that is free."""

    position: Vector
    tool: Vector | None
    roll: Roll

    @property
    def held_tool(self) -> Vector:
        assert self.tool is not None
        return self.tool

    def wrist(self, arm: CanonicalArm) -> Vector:
        """Return the wrist that holds the tool's direction, m."""
        (x, y, z), (tx, ty, tz), size = self.position, self.held_tool, arm.tool
        return x - size * tx, y - size * ty, z - size * tz

    def within_lengths(self, arm: CanonicalArm) -> Goal:
        """Return the nearest goal that the lengths of the links and the elbow's tilt allow."""
        if self.tool is None:
            x, y, z = self.position
            square = x * x + y * y + z * z
            if square <= arm.reach * arm.reach:
                return self
            return self._replace(position=scale(self.position, arm.reach / sqrt(square)))
        wrist = self.wrist(arm)
        far = length(wrist)
        if arm.nearest <= far <= arm.farthest or far < _TINY:
            return self
        held = scale(wrist, (arm.nearest if far < arm.nearest else arm.farthest) / far)
        return self._replace(position=add(held, scale(self.tool, arm.tool)))

    def errors(self, arm: CanonicalArm, theta: Angles, links: Chain) -> tuple[float, float]:
        """Return how far θ, whose chain is `links`, is from the goal: m and rad."""
        position_error = dist(self.position, tip(arm, links))
        if self.tool is None:
            return position_error, 0.0
        # Axis · sine and cosine of the rotation from θ's tool to the goal's.
        (tx, ty, tz), (bx, by, bz) = links[2], self.tool
        x, y, z = ty * bz - tz * by, tz * bx - tx * bz, tx * by - ty * bx
        cosine = tx * bx + ty * by + tz * bz
        if self.roll is not None:
            # The skew part and the trace give exact small angles, too.
            wx, wy, wz = links[5]
            sx, sy, sz = wy * tz - wz * ty, wz * tx - wx * tz, wx * ty - wy * tx
            c, s = cos(theta[6]), sin(theta[6])
            ax, ay, az = c * sx + s * wx, c * sy + s * wy, c * sz + s * wz
            cx, cy, cz = c * wx - s * sx, c * wy - s * sy, c * wz - s * sz
            (bx, by, bz), (dx, dy, dz) = self.roll
            x += ay * bz - az * by + cy * dz - cz * dy
            y += az * bx - ax * bz + cz * dx - cx * dz
            z += ax * by - ay * bx + cx * dy - cy * dx
            trace = cosine + ax * bx + ay * by + az * bz + cx * dx + cy * dy + cz * dz
            x, y, z, cosine = 0.5 * x, 0.5 * y, 0.5 * z, 0.5 * (trace - 1.0)
        return position_error, atan2(sqrt(x * x + y * y + z * z), cosine)
