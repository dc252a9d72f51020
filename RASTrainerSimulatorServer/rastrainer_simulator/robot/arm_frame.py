"""Between World and q outside, and the arm's own frame and θ inside FABRIK."""

from __future__ import annotations

from collections.abc import Sequence
from math import isfinite, sqrt

from rastrainer.errors import InputError
from rastrainer_simulator.robot.srs_geometry import SrsGeometry
from rastrainer_simulator.vectors import Vector, cross, dot, reject, unit

# A rotation whose columns are not perpendicular unit vectors to this is no rotation.
_SKEW = 1e-6


class ArmFrame:
    """Converts targets and joint angles; plain floats, whatever comes in."""

    def __init__(self, geometry: SrsGeometry) -> None:
        self._base = tuple(map(tuple, geometry.base.tolist()))
        self._shoulder = tuple(geometry.shoulder.tolist())
        self._tip = tuple(map(tuple, geometry.tip_rotation.tolist()))
        self._joints = tuple(
            zip(geometry.signs, geometry.offsets, geometry.q_lower, geometry.q_upper, strict=True)
        )

    def theta(self, q: Sequence[float]) -> tuple[float, ...]:
        """Return θ of q (rad), moved into the limits where it is outside."""
        if len(q) != 7:
            raise InputError(f"A posture has seven joint angles, not {len(q)}.")
        theta = tuple(
            [
                sign * (lower if angle < lower else upper if angle > upper else float(angle))
                + offset
                for angle, (sign, offset, lower, upper) in zip(q, self._joints, strict=True)
            ]
        )
        if not isfinite(sum(theta)):
            raise InputError("The joint angles to start from must be finite.")
        return theta

    def q(self, theta: Sequence[float]) -> tuple[float, ...]:
        """Return q (rad) of θ, inside the limits to the last bit."""
        angles = []
        for angle, (sign, offset, lower, upper) in zip(theta, self._joints, strict=True):
            angle = sign * (angle - offset)
            angles.append(lower if angle < lower else upper if angle > upper else angle)
        return tuple(angles)

    def position(self, world: Sequence[float]) -> Vector:
        """Return a point of World (m) as seen from the shoulder."""
        x, y, z = _three(world, "target position")
        sx, sy, sz = self._shoulder
        return self._turned((x - sx, y - sy, z - sz))

    def direction(self, world: Sequence[float]) -> Vector:
        """Return a direction of World as a unit vector of the arm's frame."""
        x, y, z = _three(world, "tool direction")
        size = sqrt(x * x + y * y + z * z)
        if size < 1e-9:
            raise InputError("The tool direction has no length.")
        return self._turned((x / size, y / size, z / size))

    def rotation(self, world: Sequence[Sequence[float]]) -> tuple[Vector, Vector, Vector]:
        """Return the tool's x, y and z axes in the arm's frame for a rotation (3, 3) of the tip."""
        try:
            columns = list(zip(*world, strict=True))
            right, left, ahead = (self._turned(_three(axis, "tool rotation")) for axis in columns)
        except (TypeError, ValueError) as error:
            raise InputError("The tool rotation must be three rows of three numbers.") from error
        lengths = (dot(right, right), dot(left, left), dot(cross(right, left), ahead))
        slants = (dot(right, left), dot(left, ahead), dot(ahead, right))
        if max(abs(value - 1.0) for value in lengths) + max(map(abs, slants)) > _SKEW:
            raise InputError(
                "The tool rotation is none: its columns must be perpendicular unit vectors, "
                "the third being the first cross the second."
            )
        x, y = (
            tuple([a * right[i] + b * left[i] + c * ahead[i] for i in range(3)])
            for a, b, c in self._tip[:2]
        )
        tool = unit(cross(x, y))
        x = unit(reject(x, tool))
        return x, cross(tool, x), tool

    def _turned(self, vector: Vector) -> Vector:
        x, y, z = vector
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = self._base
        return (
            ax * x + ay * y + az * z,
            bx * x + by * y + bz * z,
            cx * x + cy * y + cz * z,
        )


def _three(values: Sequence[float], name: str) -> Vector:
    try:
        x, y, z = values
        x, y, z = float(x), float(y), float(z)
    except (TypeError, ValueError) as error:
        raise InputError(f"The {name} must be three numbers.") from error
    if not isfinite(x + y + z):
        raise InputError(f"The {name} must be three finite numbers.")
    return x, y, z
