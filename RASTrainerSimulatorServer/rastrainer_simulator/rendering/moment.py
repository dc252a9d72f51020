"""One moment of a simulation as it is to be pictured: where all is, and in which color."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from rastrainer.protocol import Proximity
from rastrainer.units import MM_PER_M
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.scene.materials import NEXT, TIP_FREE, TIP_NEAR, TOUCHED, Material
from rastrainer_simulator.scene.robot_nodes import TIP_MARKER, TOOL, link_node_name


@dataclass(frozen=True)
class SceneMoment:
    """What a picture needs beside the scene.

    Attributes:
        link_to_world: a (4, 4) float pose in m for every link, as `Kinematics.links` gives them.
        head_to_world: (4, 4) float, mm, from the MRI's RAS to World.
        head_base: (3,) float, RAS mm, the middle of the head's base, where the stand ends.
        touched: labels of the fiducials that are done.
        next_point: label of the one to touch now.
        proximity: the tip is blue while free, and red near and on the head.
    """

    link_to_world: Mapping[str, np.ndarray]
    head_to_world: np.ndarray
    head_base: np.ndarray
    touched: frozenset[str] = frozenset()
    next_point: str | None = None
    proximity: Proximity = Proximity.FREE

    def poses(self, robot: RobotModel) -> dict[str, np.ndarray]:
        """Return where each node is that moves, (4, 4) float, m."""
        first: dict[str, np.ndarray] = {}
        for link in robot.links:
            first.setdefault(link_node_name(link.joint), self.link_to_world[link.name])
        head = np.array(self.head_to_world, dtype=float)
        head[:3, 3] /= MM_PER_M
        stand = np.eye(4)
        stand[:3, 3] = head[:3, :3] @ self.head_base / MM_PER_M + head[:3, 3]
        tool = self.link_to_world[robot.tip.name]
        return {**first, TOOL: tool, "head": head, "stand": stand}

    def looks(self) -> dict[str, Material]:
        """Return the materials of the nodes whose color tells something."""
        colors = {f"fiducial_{label}": TOUCHED for label in self.touched}
        if self.next_point is not None:
            colors[f"fiducial_{self.next_point}"] = NEXT
        colors[TIP_MARKER] = TIP_FREE if self.proximity is Proximity.FREE else TIP_NEAR
        return colors
