"""Where the arm's capsules are in one posture."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from rastrainer_simulator.collision.robot_shape import RobotShape
from rastrainer_simulator.vectors import Vector


class PosedArm(NamedTuple):
    """The arm's n capsules in World, m; the rows are those of `ArmCapsules`."""

    poses: np.ndarray  # (links + 1, 4, 4) float: LinkToWorld of each link, ToolTipToWorld last
    ends: np.ndarray  # (n, 2, 3) float: start and end of each axis
    tip: Vector

    def axis(self, row: int) -> list[Vector]:
        """Return start and end of a capsule's axis as plain floats."""
        return self.ends[row].tolist()

    @property
    def middles(self) -> np.ndarray:
        """Return the middle of each axis, (n, 3) float."""
        return (self.ends[:, 0] + self.ends[:, 1]) / 2.0


class ArmCapsules:
    """The capsules of a robot in one row: those of the links, from the base, then the tool's."""

    def __init__(self, shape: RobotShape) -> None:
        bodies = (*shape.links, shape.tool)
        rows = [(row, capsule) for row, body in enumerate(bodies) for capsule in body.capsules]
        self.capsules = tuple(capsule for _, capsule in rows)
        self.body = np.array([row for row, _ in rows])
        self.names = tuple(bodies[row].name for row in self.body)
        self.joints = np.array([bodies[row].joint for row in self.body])
        self.radii = np.array([capsule.radius for capsule in self.capsules])
        self.link_count = len(rows) - len(shape.tool.capsules)
        """How many of the capsules belong to links; the rest are the tool's."""
        starts = np.array([capsule.start for capsule in self.capsules])
        ends = np.array([capsule.end for capsule in self.capsules])
        self.reach = np.linalg.norm(ends - starts, axis=1) / 2.0 + self.radii
        """(n,) float: radius of the sphere about each capsule, m."""
        self._frames = (*(link.name for link in shape.links), shape.tip_name)
        # One product with all poses, their columns one below the other, gives all ends.
        columns = np.zeros((len(rows), 2, len(self._frames), 4))
        for end, points in enumerate((starts, ends)):
            columns[range(len(rows)), end, self.body, :3] = points
            columns[range(len(rows)), end, self.body, 3] = 1.0
        self._ends = columns.reshape(2 * len(rows), -1)

    def pose(self, link_to_world: Mapping[str, np.ndarray]) -> PosedArm:
        """Return the capsules in World; `link_to_world` holds (4, 4) float by link, the tip too."""
        poses = np.array([link_to_world[name] for name in self._frames])
        columns = poses[:, :3].swapaxes(1, 2).reshape(-1, 3)
        ends = (self._ends @ columns).reshape(-1, 2, 3)
        return PosedArm(poses, ends, tuple(poses[-1, :3, 3].tolist()))
