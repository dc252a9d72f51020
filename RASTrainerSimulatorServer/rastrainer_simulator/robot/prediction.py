"""The warm start: a step along the Jacobian, clamped to the joint limits.

FABRIK alone spreads a small motion over the chain as the geometry happens to; the step of least
joint motion (damped pseudo-inverse, Nakamura & Hanafusa 1986, 10.1115/1.3143764) spreads it evenly,
and the exact closure has only its second-order error to remove.
"""

from __future__ import annotations

from rastrainer_simulator.robot.canonical_arm import (
    Angles,
    CanonicalArm,
    Chain,
    chain,
    clamped,
    inside,
)
from rastrainer_simulator.robot.goal import Goal
from rastrainer_simulator.robot.least_squares import Row, damped_step
from rastrainer_simulator.vectors import Vector, cross, dot

# A goal farther than this is no continuation of the last one: the Jacobian says nothing about it.
_NEAR_M = 0.03
_NEAR_COSINE = 0.95
_DAMPING = 1e-6
_LARGEST_STEP = 0.3
_ROUNDS = 3
_MOST_STEPS = 4
_SMALL_TILT = 0.1
_EXACT = 1e-10


def predict(
    arm: CanonicalArm, theta: Angles, links: Chain, goal: Goal
) -> tuple[Angles, Chain] | None:
    """Return θ nearer to the goal, inside the limits, and its chain.

    None where the goal is so far away that this is a cold start.
    """
    if goal.tool and dot(links[2], goal.tool) < _NEAR_COSINE:
        return None
    for _ in range(_MOST_STEPS):
        arms = _arms(arm, links)
        error = _error(arms[0], goal.position)
        if error is None:
            return None
        moved = _position_step(theta, links, arms, error) if goal.tool is None else None
        free = moved is not None and inside(moved, arm.limits)
        if free:
            theta = moved
        else:
            rows, wanted = _equations(theta, links, arms, error, goal)
            theta, free = _step_inside_limits(arm, theta, rows, wanted)
        links = chain(theta)
        # What a step leaves over is the closure's to remove; close to a singularity or a limit
        # that little would still turn a pan far or leave the limits, so there it is refined.
        if (free and _clear(theta)) or max(goal.errors(arm, theta, links)) < _EXACT:
            break
    return theta, links


def _clear(theta: Angles) -> bool:
    """Tell whether shoulder, elbow and wrist are clear of their singularities."""
    small = _SMALL_TILT
    return not (-small < theta[1] < small or -small < theta[3] < small or -small < theta[5] < small)


def _arms(arm: CanonicalArm, links: Chain) -> tuple[Vector, Vector, Vector]:
    """Return the tip as seen from shoulder, elbow and wrist."""
    (ux, uy, uz), (fx, fy, fz), (tx, ty, tz), *_ = links
    a, b, c = arm.upper, arm.fore, arm.tool
    tx, ty, tz = c * tx, c * ty, c * tz
    fx, fy, fz = tx + b * fx, ty + b * fy, tz + b * fz
    return (fx + a * ux, fy + a * uy, fz + a * uz), (fx, fy, fz), (tx, ty, tz)


def _error(tip: Vector, target: Vector) -> Vector | None:
    x, y, z = target[0] - tip[0], target[1] - tip[1], target[2] - tip[2]
    return (x, y, z) if x * x + y * y + z * z < _NEAR_M * _NEAR_M else None


def _position_step(
    theta: Angles, links: Chain, arms: tuple[Vector, Vector, Vector], error: Vector
) -> Angles | None:
    """Return θ + Jᵀ (J Jᵀ + damping)⁻¹ error for the tip's position: three equations, by hand.

    Joint 7 does not move a tip on its axis. None where the step would be too long to trust.
    """
    (ux, uy, uz), (fx, fy, fz), _, (ax, ay, _), (bx, by, bz), (cx, cy, cz) = links
    (px, py, pz), (ex, ey, ez), (dx, dy, dz) = arms
    t1, t2, t3, t4, t5, t6, t7 = theta
    # The columns of J: axis × arm of joints 1 to 6; the first has no z.
    x1, y1 = -py, px
    x2, y2, z2 = ay * pz, -ax * pz, ax * py - ay * px
    x3, y3, z3 = uy * ez - uz * ey, uz * ex - ux * ez, ux * ey - uy * ex
    x4, y4, z4 = by * ez - bz * ey, bz * ex - bx * ez, bx * ey - by * ex
    x5, y5, z5 = fy * dz - fz * dy, fz * dx - fx * dz, fx * dy - fy * dx
    x6, y6, z6 = cy * dz - cz * dy, cz * dx - cx * dz, cx * dy - cy * dx
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
    # The squared length of the step, but for the damping.
    if gx * x + gy * y + gz * z > _LARGEST_STEP * _LARGEST_STEP:
        return None
    return (
        t1 + x1 * x + y1 * y,
        t2 + x2 * x + y2 * y + z2 * z,
        t3 + x3 * x + y3 * y + z3 * z,
        t4 + x4 * x + y4 * y + z4 * z,
        t5 + x5 * x + y5 * y + z5 * z,
        t6 + x6 * x + y6 * y + z6 * z,
        t7,
    )


def _equations(
    theta: Angles, links: Chain, arms: tuple[Vector, Vector, Vector], error: Vector, goal: Goal
) -> tuple[list[Row], Row]:
    """Return the Jacobian's rows and the errors of what the goal fixes: 3, 5 or 6 equations."""
    upper, fore, tool, axis2, axis4, axis6 = links
    tip, from_elbow, from_wrist = arms
    axes = ((0.0, 0.0, 1.0), axis2, upper, axis4, fore, axis6, tool)
    reach = (tip, tip, from_elbow, from_elbow, from_wrist, from_wrist, from_wrist)
    columns = [cross(axis, arm) for axis, arm in zip(axes, reach, strict=True)]
    if goal.tool is None:
        return list(zip(*columns, strict=True)), error
    turn, _ = goal.turn(theta, links)
    if goal.roll:
        return [*zip(*columns, strict=True), *zip(*axes, strict=True)], (*error, *turn)
    # Turning about the tool itself is free: only its two components beside the tool count.
    across = cross(axis6, tool)
    beside = [[dot(axis, axis6) for axis in axes], [dot(axis, across) for axis in axes]]
    wanted = (*error, dot(turn, axis6), dot(turn, across))
    return [*zip(*columns, strict=True), *beside], wanted


def _step_inside_limits(
    arm: CanonicalArm, theta: Angles, rows: list[Row], wanted: Row
) -> tuple[Angles, bool]:
    """Return θ after the damped step, and whether no limit was met.

    A joint that would pass its limit stops there and the others go on.
    """
    stopped: dict[int, float] = {}
    for _ in range(_ROUNDS):
        step = damped_step(rows, wanted, _DAMPING)
        longest = max(map(abs, step))
        if longest > _LARGEST_STEP:
            step = [part * _LARGEST_STEP / longest for part in step]
        for joint, part in stopped.items():
            step[joint] = part
        moved = tuple([a + b for a, b in zip(theta, step, strict=True)])
        if inside(moved, arm.limits):
            return moved, not stopped
        held = clamped(moved, arm.limits)
        outside = [j for j in range(7) if held[j] != moved[j] and j not in stopped]
        beyond = {j: held[j] - theta[j] for j in outside}
        stopped |= beyond
        wanted = [
            value - sum([row[joint] * part for joint, part in beyond.items()])
            for row, value in zip(rows, wanted, strict=True)
        ]
        rows = [[0.0 if j in stopped else part for j, part in enumerate(row)] for row in rows]
    return held, False
