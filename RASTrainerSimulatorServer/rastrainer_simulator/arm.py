"""The arm in one posture, and how it gets from there to the next within its joints' speed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.teleoperation.axes import Axes
from rastrainer_simulator.teleoperation.teleoperation import Tip
from rastrainer_simulator.vectors import Vector


@dataclass(frozen=True)
class Posture:
    """Where the arm is.

    Attributes:
        q: seven joint angles, rad.
        link_to_world: by the link's name, the tip's among them, (4, 4) float, m.
        links: the poses among them that follow each joint, base first.
        tool_tip_to_world: (4, 4) float, m.
        tip: the tip's position and the tool's direction.
    """

    q: tuple[float, ...]
    link_to_world: Mapping[str, np.ndarray]
    links: tuple[np.ndarray, ...]
    tool_tip_to_world: np.ndarray
    tip: Tip

    @property
    def tool_axes(self) -> Axes:
        """The axes of the tool's tip: x, y and z in World."""
        x, y, z, _ = self.tool_tip_to_world.T.tolist()
        return Axes(tuple(x[:3]), tuple(y[:3]), tuple(z[:3]))


class Arm:
    """Solves for postures; it keeps none itself."""

    def __init__(self, robot: RobotModel) -> None:
        self._robot = robot
        self._kinematics = make_kinematics(robot)
        self._fabrik = Fabrik(robot)
        self._link_names = _first_links(robot)
        self._fastest = tuple(float(speed) for speed in robot.velocity)
        self.home = self.posture(robot.home)

    def posture(self, q: tuple[float, ...]) -> Posture:
        """Return the posture with these joint angles."""
        links = self._kinematics.links(q)
        pose = links[self._robot.tip.name]
        (_, _, dx, x), (_, _, dy, y), (_, _, dz, z), _ = pose.tolist()
        in_order = tuple(links[name] for name in self._link_names)
        return Posture(q, links, in_order, pose, Tip((x, y, z), (dx, dy, dz)))

    def toward(
        self, start: Posture, position: Vector, direction: Vector | None, dt: float
    ) -> tuple[tuple[float, ...], bool]:
        """Return the joint angles after `dt` on the way to a target, and if it is within reach.

        All joints are slowed down by the same factor where one would be too fast, so that the way
        in joint space stays the same.
        """
        solution = self._fabrik.solve(position, direction, q_start=start.q)
        factor = 1.0
        for old, new, fastest in zip(start.q, solution.q, self._fastest, strict=True):
            way = abs(new - old)
            if way * factor > fastest * dt:
                factor = fastest * dt / way
        if factor == 1.0:
            return solution.q, solution.converged
        steps = zip(start.q, solution.q, strict=True)
        return tuple(old + factor * (new - old) for old, new in steps), solution.converged


def _first_links(robot: RobotModel) -> tuple[str, ...]:
    """Return the names of the base and of the first link behind each joint."""
    names = {}
    for link in robot.links:
        names.setdefault(link.joint, link.name)
    return tuple(names[joint] for joint in sorted(names))
