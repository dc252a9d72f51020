"""Which places of a head the robot can touch, wherever the head of a trial may stand."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from rastrainer import transforms
from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.planning.touch_planner import TouchPlanner

MM_PER_M = 1000.0


def touchable(
    planner: TouchPlanner,
    collision: Collision,
    positions: np.ndarray,
    normals: np.ndarray,
    poses: Iterable[np.ndarray],
) -> np.ndarray:
    """Return which places (n,) bool can be touched in every pose of the head.

    Args:
        planner: looks for the touches, with the same `collision`.
        collision: its head is put into each pose.
        positions: (n, 3) float, RAS mm.
        normals: (n, 3) float, outward unit normals, RAS.
        poses: HeadToWorld, (4, 4) float, mm, one after the other.
    """
    can_be = np.ones(len(positions), dtype=bool)
    likely = np.zeros(len(positions), dtype=int)
    for head_to_world in poses:
        pose = np.array(head_to_world, dtype=float)
        pose[:3, 3] /= MM_PER_M
        collision.set_head_pose(pose)
        for place in np.flatnonzero(can_be):
            position = transforms.apply(pose, positions[place] / MM_PER_M)
            normal = pose[:3, :3] @ normals[place]
            found = planner.working_direction(position, normal, int(likely[place]))
            can_be[place] = found is not None
            likely[place] = found or 0
    return can_be
