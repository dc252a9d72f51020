"""Finds the parts of the arm that cover the trainee's target: views draw them translucent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from rastrainer.protocol import OPEN_PHASES
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M, apply
from rastrainer_simulator.collision.clearance import sight_clearances
from rastrainer_simulator.collision.robot_shape import ArmCapsules
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.scene.nodes import TOOL, link_node_name
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.vectors import Vector, vector

COVERS_M, FLICKER_M = 0.005, 0.01
"""A body covers the places seen along a line of sight that it comes so near to: a point is a disk.
It does so until it is so much farther away, so that it does not flicker."""
SLENDER_M = 0.005
SLENDER_COVERS_M, SLENDER_FLICKER_M = 0.0, 0.003
"""Radius up to which a part of the tool is slender, and the margins of such a part."""
MARKER_M = 0.009
"""The tool itself has to be seen so near the tip."""


class ArmCover:
    """Finds the bodies of one robot that cover something; it remembers what did before."""

    def __init__(self, setup: SimulationSetup) -> None:
        self.setup = setup
        links = {link.name: link for link in setup.robot.links}
        first = setup.robot.moving_links
        self._arm = ArmCapsules(setup.shape)
        self._tip = setup.robot.tip.name
        self._fixed = {
            name: (joint, np.linalg.inv(first[joint].offset) @ links[name].offset)
            for name, joint in ((body.name, body.joint) for body in setup.shape.links)
        }
        nodes = {
            name: link_node_name(joint) if first[joint].name == name else TOOL
            for name, (joint, _offset) in self._fixed.items()
        }
        self._nodes = np.array([nodes.get(name, TOOL) for name in self._arm.names])
        is_broad = self._arm.radii > SLENDER_M
        self._margins = np.where(is_broad, COVERS_M, SLENDER_COVERS_M)
        self._flicker = np.where(is_broad, FLICKER_M, SLENDER_FLICKER_M)
        # The tool's capsules are in the frame of its tip.
        is_tip = np.array([np.linalg.norm(each.start) < MARKER_M for each in self._arm.capsules])
        self._margins[is_tip & (np.arange(len(is_tip)) >= self._arm.link_count)] = -np.inf
        self._covering: dict[str, frozenset[str]] = {}

    def covering(
        self, now: SimulationState, eyes: Mapping[str, Vector | None], places: Sequence[Vector]
    ) -> dict[str, tuple[str, ...]]:
        """Return the nodes that cover any of some places from each eye, by the eyes' names.

        World, m; an eye that is None, as of nobody, sees nothing covered.
        """
        poses = {
            name: now.link_to_world[joint] @ offset for name, (joint, offset) in self._fixed.items()
        }
        ends = self._arm.pose({**poses, self._tip: now.tool_tip_to_world}).ends
        for name, eye in eyes.items():
            known = self._covering.get(name, frozenset())
            if eye is None or not len(places):
                self._covering[name] = frozenset()
                continue
            lines = np.array(places)
            eyes_of_lines = np.broadcast_to(eye, lines.shape)
            off = sight_clearances(eyes_of_lines, lines, ends, self._arm.radii).min(axis=0)
            off -= self._margins
            near, nearer = (set(self._nodes[off < more].tolist()) for more in (self._flicker, 0.0))
            # A node that is known to be there is so until it has left by a margin.
            self._covering[name] = known & near | nearer
        return {name: tuple(sorted(self._covering[name])) for name in eyes}


def places_to_see(
    now: SimulationState, scenario: Scenario, guided: Sequence[float] | None = None
) -> list[Vector]:
    """Return what must be seen while a trial is open: the tip, and where it should go; World, m.

    That is the next point, if it is marked, else the place `guided` to, in the head's frame, mm.
    """
    training = now.training
    if training.phase not in OPEN_PHASES:
        return []
    if training.next_point is not None and training.is_marked:
        task = scenario.task(training.task)
        guided = task.fiducials[task.labels.index(training.next_point)].tolist()
    if guided is None:
        return [now.tip]
    return [now.tip, vector(apply(now.head_to_world, np.array(guided) / MM_PER_M).tolist())]
