"""A 7R S-R-S arm: recognized by its joints, and as plain floats for FABRIK's inner loops.

Three axes that meet in one point act as a shoulder, three as a wrist, and the elbow lies where the
third, fourth and fifth axes meet (Shimizu et al. 2008, 10.1109/TRO.2008.2003266, section II).
With any axis conventions, such an arm is the canonical chain

    Rz(θ1) Ry(θ2) · upper · Rz(θ3) Ry(θ4) · fore · Rz(θ5) Ry(θ6) · tool · Rz(θ7),

whose links all lie along z at θ = 0, with θ = sign · q + offset. The plain floats live in the arm's
own frame: the shoulder is the origin and θ2 = 0 points the upper arm along z.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, sin

import numpy as np

from rastrainer.errors import InputError
from rastrainer_simulator.vectors import Vector

# How far an arm may be from an exact S-R-S arm: m, or the cosine of the angle between two axes.
_MISFIT = 1e-9
_HOME = tuple(math.radians(angle) for angle in (0.0, 30.0, 0.0, 90.0, 0.0, 60.0, 0.0))


@dataclass(frozen=True)
class Joint:
    """A revolute joint: where it sits on the link before it, and how it may move."""

    name: str
    origin: np.ndarray  # (4, 4) float: this joint's frame to the movable frame before it, m
    axis: np.ndarray  # (3,) float: unit vector in this joint's frame
    lower: float  # rad
    upper: float  # rad
    velocity: float  # rad/s


@dataclass(frozen=True)
class SrsGeometry:
    """The canonical chain of an S-R-S arm; meters and radians."""

    base: np.ndarray  # (3, 3) float: rotates World into the canonical base frame
    shoulder: np.ndarray  # (3,) float: in World
    upper: float  # shoulder to elbow
    fore: float  # elbow to wrist
    tool: float  # wrist to tool tip
    signs: tuple[float, ...]
    offsets: tuple[float, ...]
    q_lower: tuple[float, ...]
    q_upper: tuple[float, ...]
    tip_rotation: np.ndarray  # (3, 3) float: rotates the tip's frame into the last canonical frame

    @property
    def canonical_limits(self) -> tuple[tuple[float, float], ...]:
        """Lower and upper limit of each θ."""
        ends = zip(self.signs, self.offsets, self.q_lower, self.q_upper, strict=True)
        return tuple(
            (offset + lower, offset + upper) if sign > 0.0 else (offset - upper, offset - lower)
            for sign, offset, lower, upper in ends
        )

    def home(self) -> tuple[float, ...]:
        """Return q of the home pose: elbow bent by 90°, tool against the base's axis."""
        return tuple(
            min(max(sign * (angle - offset), lower), upper)
            for angle, sign, offset, lower, upper in zip(
                _HOME, self.signs, self.offsets, self.q_lower, self.q_upper, strict=True
            )
        )


def srs_geometry(joints: Sequence[Joint], tip_offset: np.ndarray) -> SrsGeometry:
    """Return the canonical chain of seven joints with a tip fixed at `tip_offset` (4, 4)."""
    pose, places, directions = np.eye(4), [], []
    for joint in joints:
        pose = pose @ joint.origin
        places.append(pose[:3, 3])
        directions.append(pose[:3, :3] @ joint.axis)
    points, axes, tip = np.array(places), np.array(directions), pose @ tip_offset
    shoulder, elbow, wrist = _centers(points, axes, tip[:3, 3])
    upper, fore, tool = (
        float(np.linalg.norm(b - a))
        for a, b in ((shoulder, elbow), (elbow, wrist), (wrist, tip[:3, 3]))
    )
    along = [(elbow - shoulder) / upper, (wrist - elbow) / fore, (tip[:3, 3] - wrist) / tool]
    base, signs, offsets = _conventions(joints, axes, along)
    turned = np.eye(3)  # The rotation of the canonical chain's end, Rz(θ1) Ry(θ2) … Rz(θ7).
    for index, angle in enumerate(offsets):
        c, s = math.cos(angle), math.sin(angle)
        about_z = [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
        about_y = [[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]
        turned = turned @ np.array(about_y if index % 2 else about_z)
    return SrsGeometry(
        base=base,
        shoulder=shoulder,
        upper=upper,
        fore=fore,
        tool=tool,
        signs=signs,
        offsets=offsets,
        q_lower=tuple(joint.lower for joint in joints),
        q_upper=tuple(joint.upper for joint in joints),
        tip_rotation=turned.T @ base @ tip[:3, :3],
    )


def _centers(points: np.ndarray, axes: np.ndarray, tip: np.ndarray) -> list[np.ndarray]:
    """Return shoulder, elbow and wrist, (3,) float each: where three axes meet."""
    misfits = [abs(float(axes[i] @ axes[i + 1])) for i in range(6)]
    centers = []
    for first in (0, 2, 4):
        # The point nearest to three lines (least squares), and its distance to the farthest.
        places, directions = points[first : first + 3], axes[first : first + 3]
        projectors = np.eye(3) - directions[:, :, None] * directions[:, None, :]
        right = (projectors @ places[:, :, None]).sum(axis=0)[:, 0]
        # Parallel lines have no such point; the least-norm solution is then off them.
        center = np.linalg.lstsq(projectors.sum(axis=0), right, rcond=None)[0]
        misses = (projectors @ (center - places)[:, :, None])[:, :, 0]
        misfits.append(float(np.linalg.norm(misses, axis=1).max()))
        centers.append(center)
    misfits.append(float(np.linalg.norm(np.cross(tip - centers[2], axes[6]))))
    if max(misfits) > _MISFIT:
        raise InputError(
            "This is not an S-R-S arm: neighboring axes should be perpendicular, three of them "
            "should meet in the shoulder, the elbow and the wrist each, and the tool tip should "
            f"lie on the last one; they are off by up to {max(misfits):.3g}."
        )
    return centers


def _conventions(
    joints: Sequence[Joint], axes: np.ndarray, along: list[np.ndarray]
) -> tuple[np.ndarray, tuple[float, ...], tuple[float, ...]]:
    """Return the base rotation (3, 3), the signs and the offsets of θ = sign · q + offset."""
    arm, forearm, tool = along
    middle = (joints[1].lower + joints[1].upper) / 2.0
    # The base axis points to where the upper arm is in the middle of its tilt.
    in_the_middle = arm * math.cos(middle) + np.cross(axes[1], arm) * math.sin(middle)
    z = axes[0] * math.copysign(1.0, axes[0] @ in_the_middle)
    y = axes[1] - z * (z @ axes[1])
    y /= np.linalg.norm(y)
    elbow_axis = axes[3] * math.copysign(1.0, y @ axes[3] + 1e-9)
    wrist_axis = axes[5] * math.copysign(1.0, elbow_axis @ axes[5] + 1e-9)
    directions = (z, y, arm, elbow_axis, forearm, wrist_axis, tool)
    signs = tuple(math.copysign(1.0, a @ b) for a, b in zip(axes, directions, strict=True))
    offsets = (
        0.0,
        _angle(z, arm, y),
        _angle(y, elbow_axis, arm),
        _angle(arm, forearm, elbow_axis),
        _angle(elbow_axis, wrist_axis, forearm),
        _angle(forearm, tool, wrist_axis),
        0.0,
    )
    return np.array([np.cross(y, z), y, z]), signs, tuple(map(float, offsets))


def _angle(a: np.ndarray, b: np.ndarray, axis: np.ndarray) -> float:
    return math.atan2(float(axis @ np.cross(a, b)), float(a @ b))


Angles = Sequence[float]
Limits = tuple[tuple[float, float], ...]
# Directions of upper arm, forearm and tool, then the axes of joints 2, 4 and 6: unit vectors.
Chain = tuple[Vector, Vector, Vector, Vector, Vector, Vector]

# Beyond every cosine: a bound that never binds.
_NEVER = 2.0
_SMALL_TILT = 0.05


@dataclass(frozen=True, slots=True)
class CanonicalArm:
    """Lengths in m, limits of θ in rad, and the bounds that the tilts put on directions.

    `…_cosines` bound the cosine of the angle between z and the upper arm, between upper arm and
    forearm, between forearm and tool. The elbow's tilt keeps the wrist between `nearest` and
    `farthest` from the shoulder.
    """

    upper: float
    fore: float
    tool: float
    limits: Limits
    shoulder_cosines: tuple[float, float]
    elbow_cosines: tuple[float, float]
    wrist_cosines: tuple[float, float]
    nearest: float
    farthest: float
    reach: float  # the stretched arm's

    @classmethod
    def of(cls, geometry: SrsGeometry) -> CanonicalArm:
        """Return the constants of an arm."""
        limits = geometry.canonical_limits
        elbow = tilt_range(*limits[3])
        return cls(
            upper=geometry.upper,
            fore=geometry.fore,
            tool=geometry.tool,
            limits=limits,
            shoulder_cosines=_cosines(tilt_range(*limits[1])),
            elbow_cosines=_cosines(elbow),
            wrist_cosines=_cosines(tilt_range(*limits[5])),
            nearest=_third_side(geometry, elbow[1]),
            farthest=_third_side(geometry, elbow[0]),
            reach=geometry.upper + geometry.fore + geometry.tool,
        )


def tilt_range(lower: float, upper: float) -> tuple[float, float]:
    """Return the smallest and largest angle that a tilt can make, its pan being free."""
    sizes = sorted((abs(lower), abs(upper)))
    return (0.0 if lower <= 0.0 <= upper else sizes[0], min(sizes[1], math.pi))


def inside(theta: Angles, limits: Limits) -> bool:
    """Return whether each θ is within its limits."""
    t1, t2, t3, t4, t5, t6, t7 = theta
    (a1, b1), (a2, b2), (a3, b3), (a4, b4), (a5, b5), (a6, b6), (a7, b7) = limits
    return (
        a1 <= t1 <= b1
        and a2 <= t2 <= b2
        and a3 <= t3 <= b3
        and a4 <= t4 <= b4
        and a5 <= t5 <= b5
        and a6 <= t6 <= b6
        and a7 <= t7 <= b7
    )


def clamped(theta: Angles, limits: Limits) -> tuple[float, ...]:
    return tuple([min(max(a, low), high) for a, (low, high) in zip(theta, limits, strict=True)])


def _cosines(tilts: tuple[float, float]) -> tuple[float, float]:
    smallest, largest = tilts
    return (
        cos(largest) if largest < math.pi else -_NEVER,
        cos(smallest) if smallest > 0.0 else _NEVER,
    )


def _third_side(geometry: SrsGeometry, bend: float) -> float:
    a, b = geometry.upper, geometry.fore
    return math.sqrt(max(0.0, a * a + b * b + 2.0 * a * b * cos(bend)))


def chain(theta: Angles) -> Chain:
    """Return where links and axes point. Joints 1, 3, 5 and 7 turn about z and the three links."""
    t1, t2, t3, t4, t5, t6, _ = theta
    s1, c1, s2, c2 = sin(t1), cos(t1), sin(t2), cos(t2)
    s3, c3, s4, c4 = sin(t3), cos(t3), sin(t4), cos(t4)
    s5, c5, s6, c6 = sin(t5), cos(t5), sin(t6), cos(t6)
    ux, uy, uz = c1 * s2, s1 * s2, c2
    # Rz(θ1) Ry(θ2) Rz(θ3): x and y; then Ry(θ4) turns x, and z becomes the forearm.
    p, r = c1 * c2, s1 * c2
    xx, xy, xz = c3 * p - s3 * s1, c3 * r + s3 * c1, -c3 * s2
    ex, ey, ez = -s3 * p - c3 * s1, c3 * c1 - s3 * r, s3 * s2
    fx, fy, fz = s4 * xx + c4 * ux, s4 * xy + c4 * uy, s4 * xz + c4 * uz
    xx, xy, xz = c4 * xx - s4 * ux, c4 * xy - s4 * uy, c4 * xz - s4 * uz
    # Rz(θ5) turns x and y; then Ry(θ6) makes z the tool.
    wx, wy, wz = c5 * ex - s5 * xx, c5 * ey - s5 * xy, c5 * ez - s5 * xz
    xx, xy, xz = c5 * xx + s5 * ex, c5 * xy + s5 * ey, c5 * xz + s5 * ez
    tx, ty, tz = s6 * xx + c6 * fx, s6 * xy + c6 * fy, s6 * xz + c6 * fz
    return (ux, uy, uz), (fx, fy, fz), (tx, ty, tz), (-s1, c1, 0.0), (ex, ey, ez), (wx, wy, wz)


def tip(arm: CanonicalArm, links: Chain) -> Vector:
    (ux, uy, uz), (fx, fy, fz), (tx, ty, tz), *_ = links
    a, b, c = arm.upper, arm.fore, arm.tool
    return (a * ux + b * fx + c * tx, a * uy + b * fy + c * ty, a * uz + b * fz + c * tz)


def clear(theta: Angles, small: float = _SMALL_TILT) -> bool:
    """Return whether shoulder, elbow and wrist are clear of their singularities by `small` rad."""
    return not (-small < theta[1] < small or -small < theta[3] < small or -small < theta[5] < small)
