"""Closed surfaces whose shape is known: heads, plates and grooves to bump into; meters."""

import numpy as np
import trimesh

from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.collision.contact import Contact, Moved
from rastrainer_simulator.collision.robot_shape import load_shape
from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import RobotModel, load_robot

Surface = tuple[np.ndarray, np.ndarray]


def ball(radius: float, subdivisions: int = 4) -> Surface:
    """Return a sphere; 4 subdivisions are 5,120 triangles, each one more four times as many."""
    sphere = trimesh.creation.icosphere(subdivisions=subdivisions, radius=radius)
    return np.array(sphere.vertices), np.array(sphere.faces)


def bumpy_head(subdivisions: int = 4, seed: int = 1) -> Surface:
    """Return an ellipsoid of a head's size with bumps and pits."""
    random = np.random.default_rng(seed)
    directions, triangles = ball(1.0, subdivisions)
    radii = np.ones(len(directions))
    for _ in range(25):
        center = random.normal(size=3)
        center /= np.linalg.norm(center)
        angles = np.arccos(np.clip(directions @ center, -1.0, 1.0))
        radii += random.uniform(-0.12, 0.2) * np.exp(-((angles / random.uniform(0.08, 0.25)) ** 2))
    return directions * radii[:, None] * [0.075, 0.095, 0.11], triangles


def box(size: tuple[float, float, float], center: tuple[float, float, float]) -> Surface:
    """Return a block with edges along the axes."""
    block = trimesh.creation.box(extents=size)
    return np.array(block.vertices) + center, np.array(block.faces)


def together(*surfaces: Surface) -> Surface:
    """Return bodies that do not touch each other as one surface."""
    counts = np.cumsum([0, *(len(vertices) for vertices, _ in surfaces)])
    return (
        np.concatenate([vertices for vertices, _ in surfaces]),
        np.concatenate(
            [faces + first for first, (_, faces) in zip(counts[:-1], surfaces, strict=True)]
        ),
    )


TICK = 0.004
ROBOT = load_robot()
SHAPE = load_shape()
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
