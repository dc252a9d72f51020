"""Solve for an arm whose URDF is rounded: it is nearly S-R-S, so a solution is nearly right.

Many URDFs write π/2 as 1.5708. What the true arm misses is added to the target, which is solved
again; each round leaves a hundredth of the error or less.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan2

import numpy as np

from rastrainer_simulator.robot.kinematics import Kinematics
from rastrainer_simulator.robot.solution import FabrikSettings, Solution

_ROUNDS = 8


def solve_rounded(
    solve: Callable[..., Solution],
    kinematics: Kinematics,
    settings: FabrikSettings,
    position: Sequence[float],
    direction: Sequence[float] | None,
    rotation: Sequence[Sequence[float]] | None,
    q_start: Sequence[float],
) -> Solution:
    """Repeat `solve` until the true `kinematics` meets the target, and return its true errors.

    The target is `position` (3,) m and `direction` (3,) or `rotation` (3, 3) or neither, in World.
    """
    solution = solve(position, direction, rotation, q_start)
    # The tool's axis in the tip's frame.
    axis = kinematics.model.geometry.tip_rotation[2]
    goal = np.asarray(position, dtype=float)
    along = None if direction is None else np.asarray(direction) / np.linalg.norm(direction)
    turn = None if rotation is None else np.asarray(rotation, dtype=float)
    aim, pointed, turned = goal, along, turn
    for _ in range(_ROUNDS):
        tip = kinematics.tip(solution.q)
        miss = goal - tip[:3, 3]
        angle = 0.0
        if along is not None:
            angle = _angle_between(tip[:3, :3] @ axis, along)
        if turn is not None:
            angle = _angle_of(turn @ tip[:3, :3].T)
        met = solution.converged
        off = float(np.linalg.norm(miss))
        solution = solution._replace(position_error_m=off, direction_error_rad=angle)
        if not met or settings.met(off, angle):
            return solution
        aim = aim + miss
        if pointed is not None and along is not None:
            pointed = pointed + along - tip[:3, :3] @ axis
        if turned is not None and turn is not None:
            turned = turn @ tip[:3, :3].T @ turned
        solution = solve(aim, pointed, turned, solution.q)
    return solution._replace(converged=False)


def _angle_between(a: np.ndarray, b: np.ndarray) -> float:
    return atan2(float(np.linalg.norm(np.cross(a, b))), float(a @ b))


def _angle_of(rotation: np.ndarray) -> float:
    skew = (rotation - rotation.T) / 2.0
    sine = float(np.linalg.norm((skew[2, 1], skew[0, 2], skew[1, 0])))
    return atan2(sine, (float(np.trace(rotation)) - 1.0) / 2.0)
