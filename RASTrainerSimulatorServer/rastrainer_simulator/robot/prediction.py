"""The warm start for a position: a step along the Jacobian, clamped to the joint limits.

FABRIK alone spreads a small motion over the chain as the geometry happens to; the step of least
joint motion (damped pseudo-inverse, Nakamura & Hanafusa 1986, 10.1115/1.3143764) spreads it evenly,
and the exact closure has only its second-order error to remove.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import dist, sqrt

from rastrainer_simulator.robot.canonical_arm import (
    Angles,
    CanonicalArm,
    Chain,
    chain,
    clamped,
    clear,
    inside,
    tip,
)
from rastrainer_simulator.vectors import ZERO, Vector, scale, subtract

_DAMPING = 1e-6
_LONGEST_STEP = 0.3
_MOST_STEPS = 4
_MOST_STOPS = 3
_EXACT = 1e-10

Columns = Sequence[Vector]


def predict(arm: CanonicalArm, theta: Angles, links: Chain, target: Vector) -> tuple[Angles, Chain]:
    """Return θ with the tip nearer to a `target` (m) close by, inside the limits, and its chain."""
    for _ in range(_MOST_STEPS):
        columns, error = _equations(arm, links, target)
        theta, free = _step_inside_limits(arm, theta, columns, error)
        links = chain(theta)
        # What a step leaves over is the closure's to remove; close to a singularity or a limit
        # that little would still turn a pan far or leave the limits, so there it is refined.
        if (free and clear(theta)) or dist(tip(arm, links), target) < _EXACT:
            break
    return theta, links


def _equations(arm: CanonicalArm, links: Chain, target: Vector) -> tuple[Columns, Vector]:
    """Return the tip's Jacobian for joints 1 to 6 by columns, axis × arm, and what the tip misses.

    Joint 7 does not move a tip on its axis.
    """
    (ux, uy, uz), (fx, fy, fz), (tx, ty, tz), (ax, ay, _), (bx, by, bz), (cx, cy, cz) = links
    a, b, c = arm.upper, arm.fore, arm.tool
    # The tip as seen from wrist, elbow and shoulder.
    tx, ty, tz = c * tx, c * ty, c * tz
    ex, ey, ez = tx + b * fx, ty + b * fy, tz + b * fz
    px, py, pz = ex + a * ux, ey + a * uy, ez + a * uz
    columns = (
        (-py, px, 0.0),
        (ay * pz, -ax * pz, ax * py - ay * px),
        (uy * ez - uz * ey, uz * ex - ux * ez, ux * ey - uy * ex),
        (by * ez - bz * ey, bz * ex - bx * ez, bx * ey - by * ex),
        (fy * tz - fz * ty, fz * tx - fx * tz, fx * ty - fy * tx),
        (cy * tz - cz * ty, cz * tx - cx * tz, cx * ty - cy * tx),
    )
    return columns, (target[0] - px, target[1] - py, target[2] - pz)


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
    # The squared length of the step, but for the damping; a long one is not to be trusted.
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

    A joint that would pass its limit stops there, and the others make up for it.
    """
    moved = _step(theta, columns, error)
    if inside(moved, arm.limits):
        return moved, True
    for _ in range(_MOST_STOPS):
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
