"""Queries and answers of FABRIK: goals and θ in the arm's frame, from World and q and back."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, dist, inf, isfinite, sin, sqrt
from typing import Annotated, NamedTuple

from rastrainer.errors import InputError
from rastrainer.json_checks import Setting, whole_number
from rastrainer_simulator.robot.closure import Roll
from rastrainer_simulator.robot.srs_arm import (
    Angles,
    CanonicalArm,
    Chain,
    SrsGeometry,
    clamped,
    inside,
    tip,
)
from rastrainer_simulator.vectors import Vector, add, dot, length, scale

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
        assert self.tool is not None
        return self.tool

    def wrist(self, arm: CanonicalArm) -> Vector:
        """Return the wrist that holds the tool's direction, m."""
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


# A rotation whose columns are not perpendicular unit vectors to this is no rotation.
_SKEW = 1e-6


class ArmFrame:
    """Converts targets and joint angles to plain floats."""

    def __init__(self, geometry: SrsGeometry) -> None:
        self._base = tuple(map(tuple, geometry.base.tolist()))
        self._shoulder = tuple(geometry.shoulder.tolist())
        # The canonical tool's x and z axes in the tip's frame.
        self._tip = tuple(map(tuple, geometry.tip_rotation[[0, 2]].tolist()))
        self._signs, self._offsets = tuple(geometry.signs), tuple(geometry.offsets)
        self._limits = geometry.canonical_limits
        self._q_limits = tuple(zip(geometry.q_lower, geometry.q_upper, strict=True))

    def theta(self, q: Sequence[float]) -> tuple[float, ...]:
        """Return θ of q (rad), clamped to the limits."""
        q1, q2, q3, q4, q5, q6, q7 = map(float, q)
        s1, s2, s3, s4, s5, s6, s7 = self._signs
        o1, o2, o3, o4, o5, o6, o7 = self._offsets
        theta = (
            s1 * q1 + o1,
            s2 * q2 + o2,
            s3 * q3 + o3,
            s4 * q4 + o4,
            s5 * q5 + o5,
            s6 * q6 + o6,
            s7 * q7 + o7,
        )
        if inside(theta, self._limits):
            return theta
        if not isfinite(sum(theta)):
            raise InputError("The joint angles to start from must be finite.")
        return clamped(theta, self._limits)

    def q(self, theta: Sequence[float]) -> tuple[float, ...]:
        """Return q (rad) of θ, inside the limits to the last bit."""
        t1, t2, t3, t4, t5, t6, t7 = theta
        s1, s2, s3, s4, s5, s6, s7 = self._signs
        o1, o2, o3, o4, o5, o6, o7 = self._offsets
        q = (
            s1 * (t1 - o1),
            s2 * (t2 - o2),
            s3 * (t3 - o3),
            s4 * (t4 - o4),
            s5 * (t5 - o5),
            s6 * (t6 - o6),
            s7 * (t7 - o7),
        )
        return q if inside(q, self._q_limits) else clamped(q, self._q_limits)

    def position(self, world: Sequence[float]) -> Vector:
        """Return a point of World (m) as seen from the shoulder."""
        x, y, z = map(float, world)
        if not isfinite(x + y + z):
            raise InputError("The target position must be three finite numbers.")
        sx, sy, sz = self._shoulder
        return self._turned((x - sx, y - sy, z - sz))

    def direction(self, world: Sequence[float]) -> Vector:
        """Return a direction of World as a unit vector of the arm's frame."""
        x, y, z = map(float, world)
        size = sqrt(x * x + y * y + z * z)
        if not 1e-9 <= size < inf:
            raise InputError("The tool direction must be a finite vector with a length.")
        return self._turned((x / size, y / size, z / size))

    def rotation(self, world: Sequence[Sequence[float]]) -> tuple[Vector, Vector, Vector]:
        """Return the tool's x, y and z axes in the arm's frame for a rotation (3, 3) of the tip."""
        (ax, bx, cx), (ay, by, cy), (az, bz, cz) = (map(float, row) for row in world)
        skew = (
            abs(ax * ax + ay * ay + az * az - 1.0)
            + abs(bx * bx + by * by + bz * bz - 1.0)
            + abs(ax * bx + ay * by + az * bz)
            + abs(ay * bz - az * by - cx)
            + abs(az * bx - ax * bz - cy)
            + abs(ax * by - ay * bx - cz)
        )
        if not skew <= _SKEW:
            raise InputError("The tool rotation's columns must be perpendicular unit vectors.")
        (fx, fy, fz), (gx, gy, gz) = self._tip
        x, y, z = self._turned(
            (gx * ax + gy * bx + gz * cx, gx * ay + gy * by + gz * cy, gx * az + gy * bz + gz * cz)
        )
        size = sqrt(x * x + y * y + z * z)
        tx, ty, tz = x / size, y / size, z / size
        x, y, z = self._turned(
            (fx * ax + fy * bx + fz * cx, fx * ay + fy * by + fz * cy, fx * az + fy * bz + fz * cz)
        )
        # Perpendicular and of unit length to the last bit: the rows are so to `_SKEW` only.
        part = x * tx + y * ty + z * tz
        x, y, z = x - part * tx, y - part * ty, z - part * tz
        size = sqrt(x * x + y * y + z * z)
        x, y, z = x / size, y / size, z / size
        return (x, y, z), (ty * z - tz * y, tz * x - tx * z, tx * y - ty * x), (tx, ty, tz)

    def _turned(self, vector: Vector) -> Vector:
        x, y, z = vector
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = self._base
        return (ax * x + ay * y + az * z, bx * x + by * y + bz * z, cx * x + cy * y + cz * z)
