"""The warm start with the tool held: where the elbow goes when the joints move least.

Joints 1, 2 and 4 bring the wrist to its place and 5 to 7 turn the tool, each by a closed form of
first order. Then as much of the arm's self-motion is added as makes the joints move least
(Gauss–Newton). The exact closure has only an error of second order to remove.
"""

from __future__ import annotations

from math import cos, sin

from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, Chain, clear
from rastrainer_simulator.robot.closure import close_at
from rastrainer_simulator.robot.elbow_circle import elbow_circle
from rastrainer_simulator.robot.elbow_slide import LEAP, self_motion, squared_motion
from rastrainer_simulator.robot.goal import Goal
from rastrainer_simulator.vectors import Vector, unit

_FLAT = 1e-6
# A tilt (rad) below this has no first order to speak of.
_LINED_UP = 1e-3


def follow(arm: CanonicalArm, theta: Angles, links: Chain, goal: Goal) -> Angles | None:
    """Return joint angles at a goal close to θ, whose chain is `links`, by the least motion.

    None at a singularity or a limit, and where a joint would leap: there the elbow has to be looked
    for.
    """
    if not clear(theta, _LINED_UP):
        return None
    wrist = goal.wrist(arm)
    guess = _elbow(arm, theta, links, wrist, goal)
    if guess is None:
        return None
    (cx, cy, cz), (sx, sy, sz), _ = elbow_circle(arm, wrist, guess)
    elbow = (cx + sx, cy + sy, cz + sz)
    found = close_at(arm, elbow, wrist, goal.tool, goal.roll, theta)
    if found is None or not clear(found, _LINED_UP) or squared_motion(found, theta) > LEAP:
        return None
    return found


def _elbow(
    arm: CanonicalArm, theta: Angles, links: Chain, wrist: Vector, goal: Goal
) -> Vector | None:
    """Return about where the elbow goes, m, or None where joints line up.

    `wrist` is the goal's, m.
    """
    upper, (fx, fy, fz), _, axis2, (ex, ey, ez), _ = links
    a, b = arm.upper, arm.fore
    fx, fy, fz = b * fx, b * fy, b * fz
    x, y, z = a * upper[0] + fx, a * upper[1] + fy, a * upper[2] + fz
    # The wrist's Jacobian for joints 1, 2 and 4: axis × arm. Cramer's rule solves it.
    ax, ay = axis2[0], axis2[1]
    px, py, pz = ay * z, -ax * z, ax * y - ay * x
    qx, qy, qz = ey * fz - ez * fy, ez * fx - ex * fz, ex * fy - ey * fx
    nx, ny, nz = py * qz - pz * qy, pz * qx - px * qz, px * qy - py * qx
    determinant = x * ny - y * nx
    if -_FLAT < determinant < _FLAT:
        return None
    dx, dy, dz = wrist[0] - x, wrist[1] - y, wrist[2] - z
    d1 = (dx * nx + dy * ny + dz * nz) / determinant
    d2 = ((x * qx + y * qy) * dz - qz * (x * dx + y * dy)) / determinant
    d4 = (pz * (x * dx + y * dy) - (x * px + y * py) * dz) / determinant
    # How the forearm turns by that, and what joints 5 to 7 have to add for the tool.
    turned = (d2 * ax + d4 * ex, d2 * ay + d4 * ey, d1 + d4 * ez)
    d5, d6, d7 = _wrist_turns(theta, links, turned, goal)
    motion = self_motion(unit((x, y, z)), links, goal.roll is not None)
    if motion is None:
        return None
    r1, r2, r3, r5, r6, r7 = motion
    along = r1 * d1 + r2 * d2 + r5 * d5 + r6 * d6 + r7 * d7
    square = r1 * r1 + r2 * r2 + r3 * r3 + r5 * r5 + r6 * r6 + r7 * r7
    part = along / square
    t1, t2 = theta[0] + d1 - part * r1, theta[1] + d2 - part * r2
    out = a * sin(t2)
    return (out * cos(t1), out * sin(t1), a * cos(t2))


def _wrist_turns(theta: Angles, links: Chain, turned: Vector, goal: Goal) -> Vector:
    """Return the turns of joints 5 to 7 (rad) that the goal's tool asks of a `turned` forearm."""
    _, (fx, fy, fz), (tx, ty, tz), _, _, (wx, wy, wz) = links
    ox, oy, oz = turned
    gx, gy, gz = goal.tool
    # What the tool's tip, a unit vector, still has to move: along joint 6's axis and across it.
    mx = gx - tx - (oy * tz - oz * ty)
    my = gy - ty - (oz * tx - ox * tz)
    mz = gz - tz - (ox * ty - oy * tx)
    d5 = (mx * wx + my * wy + mz * wz) / sin(theta[5])
    ax, ay, az = wy * tz - wz * ty, wz * tx - wx * tz, wx * ty - wy * tx
    d6 = mx * ax + my * ay + mz * az
    if goal.roll is None:
        return d5, d6, 0.0
    # The goal's x axis along the tool's y axis, which is joint 6's axis turned about the tool.
    ux, uy, uz = goal.roll[0]
    c, s = cos(theta[6]), sin(theta[6])
    asked = c * (ux * wx + uy * wy + uz * wz) - s * (ux * ax + uy * ay + uz * az)
    made = ox * tx + oy * ty + oz * tz + d5 * (fx * tx + fy * ty + fz * tz)
    return d5, d6, asked - made
