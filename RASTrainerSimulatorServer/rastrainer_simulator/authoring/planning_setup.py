"""A head on its stand before the robot, and which points of it can be touched."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import astuple, replace
from functools import cached_property

import numpy as np

from rastrainer import transforms
from rastrainer.head.mesh import HeadMesh
from rastrainer.head.trial_head import Perturbation, perturbed_pose
from rastrainer.scenario.points import Task, task_file
from rastrainer.scenario.scenario import Scenario
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.authoring.touch_order import SurfaceGraph, complexity, shortest_path_mm
from rastrainer_simulator.collision.collision import head_collision
from rastrainer_simulator.collision.touch_planner import PlanReach, TouchPlanner
from rastrainer_simulator.core.setup import SimulationSetup, load_setup
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.viewpoint.best_view import TouchViews

POSES_TRIED = 12
"""Number of poses of the head, besides the nominal pose, in which a plan must be reachable."""
WIDER = 1.2
"""Perturbation of the poses for planning over the perturbation in trials: a margin."""


class PlanningSetup:
    """Robot, head (RAS mm) and set-up of one scenario; its tasks do not matter."""

    def __init__(
        self, scenario: Scenario, mesh: HeadMesh, setup: SimulationSetup | None = None
    ) -> None:
        """Take about half a second; `setup` is another robot than the usual one."""
        self.scenario = scenario
        self.mesh = mesh
        self.setup = replace(setup or load_setup(), scenario=scenario)
        self.collision = head_collision(self.setup.shape, mesh, scenario)
        self._planner = TouchPlanner(self.setup.robot, self.collision)

    @cached_property
    def reach(self) -> PlanReach:
        robot = self.setup.robot
        return PlanReach(robot, make_kinematics(robot), self.collision)

    @cached_property
    def graph(self) -> SurfaceGraph:
        return SurfaceGraph(self.mesh)

    @cached_property
    def eye(self) -> np.ndarray:
        """(3,) float, RAS mm: the default view's position, with the head in its nominal pose."""
        to_head = transforms.inverse(self.scenario.head_to_world)
        return transforms.apply(to_head, self.scenario.cameras["close-up"].position_mm)

    def measured(self, name: str, title: str, fiducials: np.ndarray) -> Task:
        """Return a task with these fiducials, and its complexity and shortest path."""
        index = complexity(fiducials, self.graph, self.eye).index
        shortest = shortest_path_mm(fiducials, self.graph)
        numbers = round(index, 2), round(shortest, 1)
        return Task(name, title, task_file(name), *numbers, fiducials=fiducials)

    @cached_property
    def views(self) -> TouchViews:
        return TouchViews(self.setup, self.mesh)

    def place_head(self, head_to_world: np.ndarray) -> np.ndarray:
        """Set the head's pose, HeadToWorld (4, 4) float, mm, and return it in m."""
        pose = transforms.in_meters(head_to_world)
        self.collision.set_head_pose(pose)
        return pose

    def poses(self, seeds: range, wider: float = 1.0) -> list[np.ndarray]:
        """Return the nominal HeadToWorld (4, 4), mm, and one for each seed."""
        limits = astuple(self.scenario.perturbation)
        wide = Perturbation(*(wider * limit for limit in limits))
        nominal, pivot = self.scenario.head_to_world, self.scenario.target.position_ras
        return [nominal, *(perturbed_pose(nominal, pivot, wide, seed) for seed in seeds)]

    def touchable(
        self, positions: np.ndarray, normals: np.ndarray, poses: Iterable[np.ndarray]
    ) -> np.ndarray:
        """Return which points (n,) bool can be touched in every pose of the head.

        The links keep 5 mm off head, stand, table and each other, and the tool's shaft, which
        starts 3 mm behind its tip, is off the head; see `TouchPlanner`. Positions (mm) and outward
        unit normals are (n, 3) float, RAS; poses are HeadToWorld, (4, 4) float, mm.
        """
        can_be = np.ones(len(positions), dtype=bool)
        likely = np.zeros(len(positions), dtype=int)
        for head_to_world in poses:
            pose = self.place_head(head_to_world)
            for place in np.flatnonzero(can_be):
                position = transforms.apply(pose, positions[place] / MM_PER_M)
                normal = pose[:3, :3] @ normals[place]
                found = self._planner.touch(position, normal, int(likely[place]))
                can_be[place] = found is not None
                likely[place] = 0 if found is None else found.number
        return can_be
