"""FABRIK for 7R S-R-S arms: tool position, position and direction, or full pose to joint angles.

1. A goal close by continues a motion, whose warm start is about where the joints go by the least
   motion of them: for a position a step along the Jacobian (`_predicted`); with the tool held the
   elbow's path (`_followed`), and close to a singularity the elbow is slid to where the joints
   move least (`elbow_slide`). A goal far away starts from the last posture.
2. FABRIK reaches backward from the target and forward from the base, and each pass closes the elbow
   exactly (`reaching`, `closure`): FABRIK alone converges slowly below a micrometer
   (J. Intell. Robot. Syst. 2023, 10.1007/s10846-023-01895-2).
3. The joint angles are read off the links, on the branch nearest to the last angles (`closure`).
4. A goal out of reach is replaced by the nearest within reach (`reaching`).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, dist, inf, isfinite, sin, sqrt

from rastrainer.errors import InputError
from rastrainer_simulator.robot.closure import Roll, elbow_circle
from rastrainer_simulator.robot.elbow_slide import LEAP, close_at, self_motion, squared_motion
from rastrainer_simulator.robot.goal import (
    BLOCKED,
    OUT_OF_REACH,
    ROLL_BLOCKED,
    FabrikSettings,
    Goal,
    Solution,
)
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.robot.reaching import Start, reach_position, reach_wrist
from rastrainer_simulator.robot.srs_arm import (
    Angles,
    CanonicalArm,
    Chain,
    chain,
    clamped,
    clear,
    inside,
    tip,
)
from rastrainer_simulator.vectors import ZERO, Vector, dot, scale, subtract, unit

# A warm start that would move a joint farther than this (rad) looks for an elbow that avoids it.
_JUMP = 0.5
_NEAR_M = 0.03
_NEAR_COSINE = 0.95
_BENT = 1e-6


class Fabrik:
    """Inverse kinematics of one arm; without memory: the same query has the same answer."""

    def __init__(self, model: RobotModel, settings: FabrikSettings | None = None) -> None:
        self.settings = settings or FabrikSettings()
        self._arm = model.arm
        self._q_limits = tuple((joint.lower, joint.upper) for joint in model.joints)

    def solve(
        self,
        target_position: Sequence[float],
        target_direction: Sequence[float] | None = None,
        target_rotation: Sequence[Sequence[float]] | None = None,
        *,
        q_start: Sequence[float],
    ) -> Solution:
        """Return joint angles inside the limits that bring the tool to a target in World.

        Position (3,), m, and rotation (3, 3) apply to the tip's frame, the direction (3,) to the
        tool, from the wrist to the tip. A rotation takes precedence over a direction; without both
        only the position counts. The posture is near to `q_start` (7,) rad.
        """
        goal = _goal(self._arm, target_position, target_direction, target_rotation)
        aim = goal.within_lengths(self._arm)
        signs = zip(self._arm.signs, q_start, strict=True)
        start: Angles = tuple([sign * float(angle) + 0.0 for sign, angle in signs])
        if not inside(start, self._arm.limits):
            if not isfinite(sum(start)):
                raise InputError("The joint angles to start from must be finite.")
            start = clamped(start, self._arm.limits)
        links = chain(start)
        # Whether the tool is not yet almost at the goal, as within a motion.
        is_far = dist(aim.position, tip(self._arm, links)) > _NEAR_M
        if aim.tool is not None and not is_far:
            is_far = dot(links[2], aim.tool) <= _NEAR_COSINE
        if is_far:
            theta = self._reach(goal, aim, start, links, inf)
        elif aim.tool is None:
            start, links = _predicted(self._arm, start, links, aim.position)
            theta = self._reach(goal, aim, start, links, _JUMP)
        else:
            theta = _followed(self._arm, start, links, aim)
            if theta is None:
                theta = self._reach(goal, aim, start, links, _JUMP)
        settings, blocked = self.settings, theta is None
        theta = start if theta is None else theta
        off, turned = goal.errors(self._arm, theta, chain(theta))
        converged = off <= settings.tolerance_m and turned <= settings.tolerance_rad
        reason = OUT_OF_REACH if off > settings.tolerance_m else ROLL_BLOCKED
        if converged or blocked:
            reason = "" if converged else BLOCKED
        q = tuple([sign * angle for sign, angle in zip(self._arm.signs, theta, strict=True)])
        q = q if inside(q, self._q_limits) else clamped(q, self._q_limits)
        return Solution(q, off, turned, converged, reason)

    def _reach(
        self, goal: Goal, aim: Goal, theta: Angles, links: Chain, farthest: float
    ) -> Angles | None:
        a, b = self._arm.upper, self._arm.fore
        (ux, uy, uz), (fx, fy, fz), _, _, (nx, ny, nz), _ = links
        ex, ey, ez = a * ux, a * uy, a * uz
        wrist = (ex + b * fx, ey + b * fy, ez + b * fz)
        if -_BENT < theta[3] < _BENT:
            # A stretched arm has no plane; joint 4's axis determines in which it will bend.
            lean = -_BENT if theta[3] >= 0.0 else _BENT
            ex += lean * (ny * uz - nz * uy)
            ey += lean * (nz * ux - nx * uz)
            ez += lean * (nx * uy - ny * ux)
        start = Start(theta, wrist, (ex, ey, ez), farthest)
        reach = reach_position if goal.tool is None else reach_wrist
        return reach(self._arm, goal, aim, start, self.settings.max_iterations)


# A rotation whose columns are not perpendicular unit vectors to this is no rotation.
_SKEW = 1e-6


def _goal(
    arm: CanonicalArm,
    position: Sequence[float],
    direction: Sequence[float] | None,
    rotation: Sequence[Sequence[float]] | None,
) -> Goal:
    """Return a target of World in the arm's frame."""
    x, y, z = map(float, position)
    if not isfinite(x + y + z):
        raise InputError("The target position must be three finite numbers.")
    place = (x + 0.0, y + 0.0, z - arm.shoulder)  # No −0.0, which could turn a pan by π.
    if rotation is not None:
        return Goal(place, *_axes(rotation))
    if direction is None:
        return Goal(place, None, None)
    x, y, z = map(float, direction)
    size = sqrt(x * x + y * y + z * z)
    if not 1e-9 <= size < inf:
        raise InputError("The tool direction must be a finite vector with a length.")
    return Goal(place, (x / size + 0.0, y / size + 0.0, z / size + 0.0), None)


def _axes(rotation: Sequence[Sequence[float]]) -> tuple[Vector, Roll]:
    """Return the tool's direction, and its x and y axes, of a rotation (3, 3) of the tip."""
    (ax, bx, cx), (ay, by, cy), (az, bz, cz) = (map(float, row) for row in rotation)
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
    # Perpendicular and of unit length to the last bit: the columns are so to `_SKEW` only.
    size = sqrt(cx * cx + cy * cy + cz * cz)
    tx, ty, tz = cx / size, cy / size, cz / size
    part = ax * tx + ay * ty + az * tz
    x, y, z = ax - part * tx, ay - part * ty, az - part * tz
    size = sqrt(x * x + y * y + z * z)
    x, y, z = x / size, y / size, z / size
    return (tx, ty, tz), ((x, y, z), (ty * z - tz * y, tz * x - tx * z, tx * y - ty * x))


_DAMPING = 1e-6
_LONGEST_STEP = 0.3
_MAX_STEPS = 4
_MAX_STOPS = 3
_EXACT = 1e-10

Columns = Sequence[Vector]


def _predicted(
    arm: CanonicalArm, theta: Angles, links: Chain, target: Vector
) -> tuple[Angles, Chain]:
    """Return θ with the tip nearer to a `target` (m) close by, inside the limits, and its chain.

    FABRIK alone spreads a small motion over the chain as the geometry happens to; the step of least
    joint motion (damped pseudo-inverse, Nakamura & Hanafusa 1986, 10.1115/1.3143764) spreads it
    evenly, and the exact closure has only its second-order error to remove.
    """
    a, b, c = arm.upper, arm.fore, arm.tool
    for _ in range(_MAX_STEPS):
        (ux, uy, uz), (fx, fy, fz), (tx, ty, tz), (ax, ay, _), (bx, by, bz), (cx, cy, cz) = links
        # The tip as seen from wrist, elbow and shoulder.
        tx, ty, tz = c * tx, c * ty, c * tz
        ex, ey, ez = tx + b * fx, ty + b * fy, tz + b * fz
        px, py, pz = ex + a * ux, ey + a * uy, ez + a * uz
        # The tip's Jacobian, axis × arm; joint 7 does not move a tip on its axis.
        columns = (
            (-py, px, 0.0),
            (ay * pz, -ax * pz, ax * py - ay * px),
            (uy * ez - uz * ey, uz * ex - ux * ez, ux * ey - uy * ex),
            (by * ez - bz * ey, bz * ex - bx * ez, bx * ey - by * ex),
            (fy * tz - fz * ty, fz * tx - fx * tz, fx * ty - fy * tx),
            (cy * tz - cz * ty, cz * tx - cx * tz, cx * ty - cy * tx),
        )
        missing = (target[0] - px, target[1] - py, target[2] - pz)
        theta, free = _step_inside_limits(arm, theta, columns, missing)
        links = chain(theta)
        # The closure removes the rest that a step leaves; close to a singularity or a limit
        # that little would still turn a pan far or leave the limits, so there it is refined.
        if (free and clear(theta)) or dist(tip(arm, links), target) < _EXACT:
            break
    return theta, links


def _step(theta: Angles, columns: Columns, error: Vector) -> Angles:
    """Return θ + Jᵀ (J Jᵀ + damping)⁻¹ error, written out: it runs at every tick."""
    (x1, y1, _), (x2, y2, z2), (x3, y3, z3), (x4, y4, z4), (x5, y5, z5), (x6, y6, z6) = columns
    t1, t2, t3, t4, t5, t6, t7 = theta
    # J Jᵀ is ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz)); Cramer's rule solves it.
    xx = x1 * x1 + x2 * x2 + x3 * x3 + x4 * x4 + x5 * x5 + x6 * x6 + _DAMPING
    xy = x1 * y1 + x2 * y2 + x3 * y3 + x4 * y4 + x5 * y5 + x6 * y6
    xz = x2 * z2 + x3 * z3 + x4 * z4 + x5 * z5 + x6 * z6
    yy = y1 * y1 + y2 * y2 + y3 * y3 + y4 * y4 + y5 * y5 + y6 * y6 + _DAMPING
    yz = y2 * z2 + y3 * z3 + y4 * z4 + y5 * z5 + y6 * z6
    zz = z2 * z2 + z3 * z3 + z4 * z4 + z5 * z5 + z6 * z6 + _DAMPING
    gx, gy, gz = error
    ix, iy, iz = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    jy, jz, kz = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    part = 1.0 / (xx * ix + xy * iy + xz * iz)
    x = part * (ix * gx + iy * gy + iz * gz)
    y = part * (iy * gx + jy * gy + jz * gz)
    z = part * (iz * gx + jz * gy + kz * gz)
    # The squared length of the step, except for the damping; a long one cannot be trusted.
    square = gx * x + gy * y + gz * z
    if square > _LONGEST_STEP * _LONGEST_STEP:
        part = _LONGEST_STEP / sqrt(square)
        x, y, z = part * x, part * y, part * z
    return (
        t1 + x1 * x + y1 * y,
        t2 + x2 * x + y2 * y + z2 * z,
        t3 + x3 * x + y3 * y + z3 * z,
        t4 + x4 * x + y4 * y + z4 * z,
        t5 + x5 * x + y5 * y + z5 * z,
        t6 + x6 * x + y6 * y + z6 * z,
        t7,
    )


def _step_inside_limits(
    arm: CanonicalArm, theta: Angles, columns: Columns, error: Vector
) -> tuple[Angles, bool]:
    """Return θ after the step, and whether no limit was met.

    A joint that would pass its limit stops there, and the others compensate for it.
    """
    moved = _step(theta, columns, error)
    if inside(moved, arm.limits):
        return moved, True
    for _ in range(_MAX_STOPS):
        held = clamped(moved, arm.limits)
        stopped = [joint for joint in range(6) if held[joint] != moved[joint]]
        for joint in stopped:
            error = subtract(error, scale(columns[joint], held[joint] - theta[joint]))
        columns = [ZERO if j in stopped else column for j, column in enumerate(columns)]
        theta = [held[j] if j in stopped else angle for j, angle in enumerate(theta)]
        moved = _step(theta, columns, error)
        if inside(moved, arm.limits):
            return moved, False
    return clamped(moved, arm.limits), False


_FLAT = 1e-6
# A tilt (rad) below this has practically no first order.
_LINED_UP = 1e-3


def _followed(arm: CanonicalArm, theta: Angles, links: Chain, goal: Goal) -> Angles | None:
    """Return joint angles at a goal close to θ, whose chain is `links`, by the least motion.

    Joints 1, 2 and 4 bring the wrist to its place and 5 to 7 turn the tool, each by a closed form
    of first order. Then as much of the arm's self-motion is added as makes the joints move least
    (Gauss–Newton).

    None at a singularity or a limit, and if a joint would leap: the elbow has to be searched there.
    """
    if not clear(theta, _LINED_UP):
        return None
    wrist = goal.wrist(arm)
    guess = _elbow(arm, theta, links, wrist, goal)
    if guess is None:
        return None
    (cx, cy, cz), (sx, sy, sz), _ = elbow_circle(arm, wrist, guess)
    elbow = (cx + sx, cy + sy, cz + sz)
    found = close_at(arm, elbow, wrist, goal.held_tool, goal.roll, theta)
    if found is None or not clear(found, _LINED_UP) or squared_motion(found, theta) > LEAP:
        return None
    return found


def _elbow(
    arm: CanonicalArm, theta: Angles, links: Chain, wrist: Vector, goal: Goal
) -> Vector | None:
    """Return roughly where the elbow goes, m, or None if joints line up.

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
    """Return the turns of joints 5 to 7 (rad) that the tool's goal needs with a turned forearm."""
    _, (fx, fy, fz), (tx, ty, tz), _, _, (wx, wy, wz) = links
    ox, oy, oz = turned
    gx, gy, gz = goal.held_tool
    # The remaining motion of the tool's tip, a unit vector: along joint 6's axis and across it.
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
    needed = c * (ux * wx + uy * wy + uz * wz) - s * (ux * ax + uy * ay + uz * az)
    made = ox * tx + oy * ty + oz * tz + d5 * (fx * tx + fy * ty + fz * tz)
    return d5, d6, needed - made
