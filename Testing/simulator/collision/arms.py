"""The arm of the tests: put somewhere, and driven tick by tick as the simulation does it."""

import numpy as np

from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.collision.contact import Contact, Moved
from rastrainer_simulator.collision.robot_shape import robot_shape
from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import RobotModel, load_robot

TICK = 0.004
ROBOT = load_robot()
SHAPE = robot_shape(ROBOT)
KINEMATICS = make_kinematics(ROBOT)
FABRIK = Fabrik(ROBOT)


def posture(tip, direction, q_start=ROBOT.home):
    """Return joint angles with the tip at a place and the tool along a direction, or None."""
    solution = FABRIK.solve(tip, direction, q_start=q_start)
    return solution.q if solution.converged else None


def at(vertices, center):
    """Return HeadToWorld that puts a surface's bounding box around `center` (3,), m."""
    pose = np.eye(4)
    pose[:3, 3] = np.asarray(center) - (vertices.min(axis=0) + vertices.max(axis=0)) / 2.0
    return pose


class Driver:
    """Moves the tip as the simulation does; `holds` keeps the tool's direction."""

    def __init__(self, collision: Collision, q, holds: bool = True, robot: RobotModel = ROBOT):
        self.contact = Contact(collision, KINEMATICS)
        self.moved: Moved = self.contact.at(q)
        self.direction = self.pose[:3, 2] if holds else None
        self._fastest = robot.velocity * TICK

    @property
    def pose(self):
        return self.moved.link_to_world[ROBOT.tip.name]

    @property
    def tip(self):
        return self.pose[:3, 3].copy()

    @property
    def clearance(self):
        return self.moved.clearance

    def push(self, displacement, direction=None):
        q, start = np.array(self.moved.q), self.tip

        def to_joints(allowed):
            aim = self.direction if direction is None else direction
            solution = FABRIK.solve(start + allowed, aim, q_start=self.moved.q)
            change = np.array(solution.q) - q
            return q + change / max(1.0, (np.abs(change) / self._fastest).max())

        self.moved = self.contact.move(self.moved.q, tuple(displacement), to_joints)
        return self.moved
