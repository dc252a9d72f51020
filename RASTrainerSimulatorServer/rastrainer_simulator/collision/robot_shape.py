"""The robot as collisions see it: capsules about its links, and a tapered row along its tool."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np

from rastrainer.files.reading import read_json
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.model import FOLDER
from rastrainer_simulator.vectors import Vector

MAX_BYTES = 2**20


@dataclass(frozen=True)
class Capsule:
    """All points within `radius` (m) of the segment from `start` to `end`, (3,) float each, m."""

    start: np.ndarray
    end: np.ndarray
    radius: float


SHAFT_START = 0.003
"""Distance behind the tip, m, from which the tool is a shaft that must not touch the head."""


@dataclass(frozen=True)
class LinkShape:
    """One link: its capsules in its own frame; `joint` is the number of joints before it."""

    name: str
    joint: int
    capsules: tuple[Capsule, ...]


@dataclass(frozen=True)
class RobotShape:
    """The arm's links, and the tool without its last 3 mm, its capsules in its tip's frame."""

    links: tuple[LinkShape, ...]
    tool: LinkShape
    tip_name: str


@cache
def load_shape() -> RobotShape:
    """Return the capsules of the robot: they were fitted once to its collision meshes."""
    stored = read_json(asset_path(*FOLDER, "capsules.json"), MAX_BYTES)
    tool, *links = (
        LinkShape(
            body["name"],
            body["joint"],
            tuple(
                Capsule(np.array(each["start"]), np.array(each["end"]), each["radius"])
                for each in body["capsules"]
            ),
        )
        for body in (stored["tool"], *stored["links"])
    )
    return RobotShape(tuple(links), tool, stored["tip_name"])


class PosedArm(NamedTuple):
    """The arm's n capsules in World, m, in the rows of `ArmCapsules`."""

    poses: np.ndarray  # (links + 1, 4, 4) float: LinkToWorld of each link, ToolTipToWorld last
    ends: np.ndarray  # (n, 2, 3) float: start and end of each axis
    tip: Vector

    @property
    def middles(self) -> np.ndarray:
        """Return the middle of each axis, (n, 3) float."""
        return (self.ends[:, 0] + self.ends[:, 1]) / 2.0


class ArmCapsules:
    """The capsules of a robot in one row: the links' capsules from the base on, then the tool's."""

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
