"""The two passes of FABRIK over wrist, elbow and shoulder, with the joints' cones.

Aristidou & Lasenby 2011 (10.1016/j.gmod.2011.05.003): reach backward from the target, then forward
from the base, each time moving a joint along the line to its neighbor to the link's length. Between
shoulder and wrist the passes need not be iterated: both keep the elbow in the half-plane through
the line from shoulder to wrist, so their limit is the nearest point of the elbow's circle, which
`elbow_circle` gives exactly. What is left to iterate is the wrist.
"""

from __future__ import annotations

from math import dist, sqrt

from rastrainer_simulator.robot.canonical_arm import CanonicalArm
from rastrainer_simulator.vectors import Vector, any_perpendicular

_SHOULDER = (0.0, 0.0, 0.0)
_UP = (0.0, 0.0, 1.0)
_TINY = 1e-12
_ROUNDING = 1e-15
_SETTLED = 1e-6


def backward(
    arm: CanonicalArm, target: Vector, wrist: Vector, elbow: Vector
) -> tuple[Vector, Vector] | None:
    """Reach from the target back to the wrist; return the wrist and the tool's direction.

    The tool stays in its cone about the forearm, the wrist in the band that the elbow's tilt
    leaves it. None where no wrist in the band is a tool's length from the target.
    """
    tool = _inside(_toward(wrist, target), _toward(elbow, wrist), arm.wrist_cosines)
    wx, wy, wz = _minus(target, arm.tool, tool)
    square = wx * wx + wy * wy + wz * wz
    if arm.nearest * arm.nearest <= square <= arm.farthest * arm.farthest:
        return (wx, wy, wz), tool
    bound = arm.nearest if square < arm.nearest * arm.nearest else arm.farthest
    return _at_distance(arm, target, (wx, wy, wz), bound)


def forward(arm: CanonicalArm, wrist: Vector, elbow: Vector) -> tuple[Vector, Vector]:
    """Reach from the shoulder to the wrist inside the cones; return wrist and elbow."""
    upper = _inside(_toward(_SHOULDER, elbow), _UP, arm.shoulder_cosines)
    elbow = _minus(_SHOULDER, -arm.upper, upper)
    fore = _inside(_toward(elbow, wrist), upper, arm.elbow_cosines)
    return _minus(elbow, -arm.fore, fore), elbow


def settle(
    arm: CanonicalArm, wrist: Vector, elbow: Vector, tool: Vector, passes: int
) -> tuple[Vector, Vector]:
    """Iterate both passes toward a wrist that cannot be reached, the tool's direction being held.

    Return the wrist and elbow that come nearest.
    """
    wanted = wrist
    for _ in range(passes):
        before = wrist
        fore = _inside(_toward(elbow, wanted), tool, arm.wrist_cosines)
        wrist, elbow = forward(arm, wanted, _minus(wanted, arm.fore, fore))
        fore = _inside(_toward(elbow, wrist), tool, arm.wrist_cosines)
        wrist = _minus(elbow, -arm.fore, fore)
        if dist(before, wrist) < _SETTLED:
            break
    return wrist, elbow


def _at_distance(
    arm: CanonicalArm, target: Vector, wrist: Vector, distance: float
) -> tuple[Vector, Vector] | None:
    """Return the wrist nearest to `wrist` at that distance (m) from the shoulder, with its tool."""
    px, py, pz = target
    reach = sqrt(px * px + py * py + pz * pz)
    if reach < _TINY:
        return None
    ax, ay, az = px / reach, py / reach, pz / reach
    along = (reach * reach + distance * distance - arm.tool * arm.tool) / (2.0 * reach)
    square = distance * distance - along * along
    if square < -_ROUNDING:
        return None
    # A remainder of the size of a rounding error has no direction.
    square = square if square > _ROUNDING else 0.0
    part = wrist[0] * ax + wrist[1] * ay + wrist[2] * az
    bx, by, bz = wrist[0] - part * ax, wrist[1] - part * ay, wrist[2] - part * az
    size = sqrt(bx * bx + by * by + bz * bz)
    if size < _TINY:
        (bx, by, bz), size = any_perpendicular((ax, ay, az)), 1.0
    beside = sqrt(square) / size
    wx, wy, wz = along * ax + beside * bx, along * ay + beside * by, along * az + beside * bz
    return (wx, wy, wz), _toward((wx, wy, wz), target)


def _toward(start: Vector, end: Vector) -> Vector:
    x, y, z = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    size = sqrt(x * x + y * y + z * z)
    return (x / size, y / size, z / size) if size > _TINY else _UP


def _minus(point: Vector, length: float, direction: Vector) -> Vector:
    return (
        point[0] - length * direction[0],
        point[1] - length * direction[1],
        point[2] - length * direction[2],
    )


def _inside(direction: Vector, axis: Vector, cosines: tuple[float, float]) -> Vector:
    """Return `direction`, turned into its cone about `axis` where it is outside."""
    cosine = direction[0] * axis[0] + direction[1] * axis[1] + direction[2] * axis[2]
    low, high = cosines
    if low <= cosine <= high:
        return direction
    bound = low if cosine < low else high
    x = direction[0] - cosine * axis[0]
    y = direction[1] - cosine * axis[1]
    z = direction[2] - cosine * axis[2]
    size = sqrt(x * x + y * y + z * z)
    if size < _TINY:
        (x, y, z), size = any_perpendicular(axis), 1.0
    sine = sqrt(max(0.0, 1.0 - bound * bound)) / size
    return (bound * axis[0] + sine * x, bound * axis[1] + sine * y, bound * axis[2] + sine * z)
