"""The arm in one posture, as the other parts need it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.collision.clearance import Clearance
from rastrainer_simulator.collision.contact import Moved
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.teleoperation.axes import Axes
from rastrainer_simulator.teleoperation.teleoperation import Tip
from rastrainer_simulator.teleoperation.tool_steering import Surface


@dataclass(frozen=True)
class Posture:
    """Where the arm is.

    Attributes:
        q: seven joint angles, rad.
        links: LinkToWorld of links 0 to 7, (4, 4) float, m.
        tool_tip_to_world: (4, 4) float, m.
        tip: the tip's position and the tool's direction.
        clearance: to the head, to itself and to the table.
    """

    q: tuple[float, ...]
    links: tuple[np.ndarray, ...]
    tool_tip_to_world: np.ndarray
    tip: Tip
    clearance: Clearance

    @property
    def tool_axes(self) -> Axes:
        """The axes of the tool's tip: its x, y and z in World."""
        x, y, z, _ = self.tool_tip_to_world.T.tolist()
        return Axes(tuple(x[:3]), tuple(y[:3]), tuple(z[:3]))

    @property
    def surface(self) -> Surface:
        """The head as the tool sees it."""
        tip = self.clearance.tip
        # A shaft that is far is no nearer than the tip, and then the tip alone counts.
        shaft = self.clearance.shaft or tip
        return Surface(tip.distance_m, tip.normal, shaft.distance_m, shaft.normal)


class Postures:
    """Makes postures of what `Contact` gives."""

    def __init__(self, robot: RobotModel) -> None:
        self._tip = robot.tip.name
        first_behind: dict[int, str] = {}
        for link in robot.links:
            first_behind.setdefault(link.joint, link.name)
        self._links = tuple(first_behind[joint] for joint in sorted(first_behind))

    def of(self, moved: Moved) -> Posture:
        """Return the posture in which a motion has ended."""
        poses = moved.link_to_world
        tip = poses[self._tip]
        (ax, _, dx, x), (ay, _, dy, y), (az, _, dz, z), _ = tip.tolist()
        return Posture(
            q=moved.q,
            links=tuple(poses[name] for name in self._links),
            tool_tip_to_world=tip,
            tip=Tip((x, y, z), (dx, dy, dz), (ax, ay, az)),
            clearance=moved.clearance,
        )
