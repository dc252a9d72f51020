"""The warm start: a step along the Jacobian, clamped to the joint limits.

FABRIK alone spreads a small motion over the chain as the geometry happens to; the step of least
joint motion (damped pseudo-inverse, Nakamura & Hanafusa 1986, 10.1115/1.3143764) spreads it evenly,
and the exact closure has only its second-order error to remove.
"""

from __future__ import annotations

import numpy as np

from rastrainer_simulator.robot.branches import inside
from rastrainer_simulator.robot.canonical_arm import Angles, CanonicalArm, Chain
from rastrainer_simulator.robot.goal import Goal, tool_axes
from rastrainer_simulator.vectors import Vector, add, cross, dot, scale

# A goal farther than this is no continuation of the last one: the Jacobian says nothing about it.
_NEAR_M = 0.03
_NEAR_COSINE = 0.95
_DAMPING = 1e-6
_LARGEST_STEP = 0.3
_ROUNDS = 3


def predict(arm: CanonicalArm, theta: Angles, links: Chain, goal: Goal) -> Angles | None:
    """Return θ a Jacobian step nearer to the goal and inside the limits.

    None where the goal is so far away that this is a cold start.
    """
    arms = _arms(arm, links)
    error = _error(arms[0], goal.position)
    if error is None or (goal.tool and dot(links[2], goal.tool) < _NEAR_COSINE):
        return None
    if goal.tool is None:
        moved = _position_step(theta, links, arms, error)
        if moved is not None and inside(moved, arm.limits):
            return moved
    return _step_inside_limits(arm, theta, *_equations(theta, links, arms, error, goal))


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
) -> tuple[np.ndarray, np.ndarray]:
    """Return the Jacobian (n, 7) and the error (n,) of what the goal fixes: 3, 5 or 6 equations."""
    upper, fore, tool, axis2, axis4, axis6 = links
    tip, from_elbow, from_wrist = arms
    axes = ((0.0, 0.0, 1.0), axis2, upper, axis4, fore, axis6, tool)
    reach = (tip, tip, from_elbow, from_elbow, from_wrist, from_wrist, from_wrist)
    columns = [cross(axis, arm) for axis, arm in zip(axes, reach, strict=True)]
    jacobian, wanted = np.array(columns).T, np.array(error)
    if goal.tool is None:
        return jacobian, wanted
    turn = cross(tool, goal.tool)
    if goal.roll:
        (x, y), (goal_x, goal_y) = tool_axes(theta, links), goal.roll
        turn = scale(add(add(turn, cross(x, goal_x)), cross(y, goal_y)), 0.5)
        directions = np.eye(3)
    else:
        directions = np.array((axis6, cross(axis6, tool)))
    return (
        np.concatenate((jacobian, directions @ np.array(axes).T)),
        np.concatenate((wanted, directions @ np.array(turn))),
    )


def _step_inside_limits(
    arm: CanonicalArm, theta: Angles, jacobian: np.ndarray, error: np.ndarray
) -> Angles:
    """Take the damped step; a joint that would pass its limit stops there and the others go on."""
    start, limits = np.array(theta), np.array(arm.limits)
    step, free = np.zeros(7), np.ones(7)
    damping = _DAMPING * np.eye(len(error))
    for _ in range(_ROUNDS):
        moving = jacobian * free
        rest = error - jacobian @ (step * (1.0 - free))
        found = np.linalg.solve(moving @ moving.T + damping, rest) @ moving
        step = np.where(free, found / max(1.0, np.abs(found).max() / _LARGEST_STEP), step)
        inside_step = np.clip(start + step, limits[:, 0], limits[:, 1]) - start
        stopped = inside_step != step
        if not stopped.any():
            break
        step, free = np.where(stopped, inside_step, step), np.where(stopped, 0.0, free)
    return tuple(np.clip(start + step, limits[:, 0], limits[:, 1]).tolist())
