"""How often arm, tool or head cover tip or point in a view, for random postures of the arm.

Rays to the meshes that are drawn, not to the collision shapes by which views are chosen.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from types import SimpleNamespace

import numpy as np
from vtkmodules.vtkCommonCore import mutable
from vtkmodules.vtkCommonDataModel import vtkStaticCellLocator

from rastrainer.head.mesh import HeadMesh, outward_normals, read_head_mesh
from rastrainer.scenario.points import Task
from rastrainer.transforms import MM_PER_M, apply
from rastrainer_simulator.collision.collision import head_collision
from rastrainer_simulator.core.setup import SimulationSetup
from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import RobotModel
from rastrainer_simulator.scene.nodes import TOOL, link_node_name
from rastrainer_simulator.scene.scene_glb import robot_nodes
from rastrainer_simulator.scene.surfaces import surface
from rastrainer_simulator.viewpoint.arm_cover import ArmCover
from rastrainer_simulator.viewpoint.best_view import TouchViews

LEANING_DEG = 55.0
SWIVEL_DEG = 80.0
"""The most that the tool leans from the skin's normal, and that the elbow is turned aside."""
AWAY_M = (0.005, 0.1)
"""Distances of tip and point while the tip is on its way."""
ROOM_M = 0.005
SKIN_M = 0.0005
BEHIND_TIP_M = 0.004
"""The middle of the tip's colored marker."""
LIFT_M, DOT_M = 0.0015, 0.003
"""The point is seen where most of its middle and four places around it are."""
AT_POINT_M = 0.01
END_ON_RAD = math.radians(20.0)


@dataclass(frozen=True)
class Posture:
    """One posture of the arm: seven joint angles, and LinkToWorld of each link by name."""

    q: tuple[float, ...]
    links: dict[str, np.ndarray]

    def state(self, robot: RobotModel) -> SimpleNamespace:
        """Return what `ArmCover` needs of a state."""
        moved = [self.links[link.name] for link in robot.links[:8]]
        return SimpleNamespace(link_to_world=moved, tool_tip_to_world=self.links[robot.tip.name])


@dataclass(frozen=True)
class Point:
    """A fiducial in World, m: position and outward normal, (3,) float."""

    label: str
    position: np.ndarray
    normal: np.ndarray


class RandomPostures:
    """Draws postures that reach a point, or stop on the way, and hit nothing."""

    def __init__(self, setup: SimulationSetup, seed: int) -> None:
        self.setup = setup
        self.head: HeadMesh = read_head_mesh(setup.scenario.head)
        self.collision = head_collision(setup.shape, self.head, setup.scenario)
        self.kinematics = make_kinematics(setup.robot)
        self.head_to_world = setup.scenario.head_to_world.copy()
        self.head_to_world[:3, 3] /= MM_PER_M
        self.collision.set_head_pose(self.head_to_world)
        self._fabrik = Fabrik(setup.robot)
        self._random = np.random.default_rng(seed)

    def points(self, task: Task) -> list[Point]:
        """Return the fiducials of a task."""
        normals = outward_normals(self.head, task.fiducials) @ self.head_to_world[:3, :3].T
        places = apply(self.head_to_world, task.fiducials / MM_PER_M)
        return [Point(*each) for each in zip(task.labels, places, normals, strict=True)]

    def at(self, point: Point, count: int) -> Iterator[Posture]:
        """Yield `count` postures with the tip on the point, and as many with it on the way."""
        on_skin = point.position + SKIN_M * point.normal
        for is_touch in (True, False):
            left = count
            while left:
                away = 0.0 if is_touch else self._random.uniform(*AWAY_M)
                place = on_skin + away * self._near(point.normal, 90.0)
                found = self._posture(place, -self._near(point.normal, LEANING_DEG))
                if found is not None:
                    left -= 1
                    yield found

    def _posture(self, place: np.ndarray, direction: np.ndarray) -> Posture | None:
        start = np.array(self.setup.robot.home)
        turn = math.radians(self._random.uniform(-SWIVEL_DEG, SWIVEL_DEG))
        start[[0, 2]] += turn, -turn
        solution = self._fabrik.solve(place.tolist(), direction.tolist(), q_start=tuple(start))
        if not solution.converged:
            return None
        links = self.kinematics.links(solution.q)
        is_clear = self.collision.is_clear(links, ROOM_M)
        if not is_clear or self.collision.check(links).tip_m < 0.0:
            return None
        return Posture(tuple(solution.q), links)

    def _near(self, axis: np.ndarray, most_deg: float) -> np.ndarray:
        """Return a unit vector, evenly distributed within an angle of another."""
        z = self._random.uniform(math.cos(math.radians(most_deg)), 1.0)
        turn = self._random.uniform(0.0, 2.0 * math.pi)
        across = np.cross(axis, np.eye(3)[np.abs(axis).argmin()])
        across /= np.linalg.norm(across)
        aside = math.cos(turn) * across + math.sin(turn) * np.cross(axis, across)
        return z * axis + math.sqrt(1.0 - z * z) * aside


class DrawnBodies:
    """The meshes of arm, tool and head as views draw them, for rays; World, m."""

    def __init__(self, postures: RandomPostures) -> None:
        head, robot = postures.head, postures.setup.robot
        self._tip_name = robot.tip.name
        self._first: dict[str, str] = {}
        for link in robot.links:
            self._first.setdefault(link_node_name(link.joint), link.name)
        self._head_to_world = postures.head_to_world
        self._meshes = {
            node.name: [_locator(each.vertices, each.triangles) for each in node.surfaces]
            for node in robot_nodes(robot)
        }
        self._meshes["head"] = [_locator(head.vertices / MM_PER_M, head.triangles)]

    def covering(self, eye: Sequence[float], point: Point, posture: Posture) -> set[str]:
        """Return what covers the tip, or most of the point, as seen from an eye.

        The slender end of the tool covers neither, and its holder only a tip seen end-on.
        """
        tip_to_world = posture.links[self._tip_name]
        tip, direction = tip_to_world[:3, 3], tip_to_world[:3, 2]
        over_tip = self._before(eye, tip - BEHIND_TIP_M * direction, posture)
        line = tip - np.asarray(eye)
        if line @ direction < math.cos(END_ON_RAD) * np.linalg.norm(line):
            over_tip -= {TOOL}
        across = np.cross(point.normal, np.eye(3)[np.abs(point.normal).argmin()])
        across *= DOT_M / np.linalg.norm(across)
        along = np.cross(point.normal, across)
        middle = point.position + LIFT_M * point.normal
        places = [middle + side for side in (0.0 * across, across, -across, along, -along)]
        over_point = [self._before(eye, place, posture) for place in places]
        if np.linalg.norm(tip - point.position) < AT_POINT_M:
            over_point = [each - {TOOL} for each in over_point]
        is_covered = sum(map(bool, over_point)) > len(places) / 2
        return over_tip.union(*over_point) if is_covered else over_tip

    def _before(self, eye: Sequence[float], place: np.ndarray, posture: Posture) -> set[str]:
        """Return the names of the bodies between an eye and a place."""
        poses = {node: posture.links[link] for node, link in self._first.items()}
        poses |= {TOOL: posture.links[self._tip_name], "head": self._head_to_world}
        return {
            name
            for name, parts in self._meshes.items()
            if any(_is_hit(part, poses[name], np.asarray(eye), place) for part in parts)
        }


def _locator(vertices: np.ndarray, triangles: np.ndarray) -> vtkStaticCellLocator:
    locator = vtkStaticCellLocator()
    locator.SetDataSet(surface(vertices, triangles))
    locator.BuildLocator()
    return locator


def _is_hit(
    locator: vtkStaticCellLocator, pose: np.ndarray, eye: np.ndarray, place: np.ndarray
) -> bool:
    start, end = ((pose[:3, :3].T @ (each - pose[:3, 3])).tolist() for each in (eye, place))
    along, hit, local = mutable(0.0), [0.0] * 3, [0.0] * 3
    numbers = mutable(0), mutable(0)
    return bool(locator.IntersectWithLine(start, end, 1e-6, along, hit, local, *numbers))


def count_covered(
    setup: SimulationSetup, seed: int, task: Task, count: int, every: int
) -> dict[str, Counter[str]]:
    """Count views of `count` postures that touch, and as many on the way, at every nth point.

    They are counted for the best view of the touch as planned, for the best view of the posture,
    and for its view along the skin: all "views"; those in which something is "covered"; those in
    which it is "hidden" by what is not translucent; those with a "needless" translucent body.
    """
    postures, cover, views = RandomPostures(setup, seed), ArmCover(setup), TouchViews(setup)
    drawn = DrawnBodies(postures)
    counts = {name: Counter[str]() for name in ("planned", "present", "beside")}
    planned = dict(views.of(task, setup.scenario.head_to_world))
    for point in postures.points(task)[::every]:
        for posture in postures.at(point, count):
            best, state = views.best(point.label, posture.q), posture.state(setup.robot)
            seen_from = planned[point.label].eye, best.eye, best.beside
            eyes = dict(zip(counts, seen_from, strict=True))
            # No posture follows another: what covered something before does not count.
            cover.covering(state, eyes, ())
            places = (state.tool_tip_to_world[:3, 3], point.position)
            translucent = cover.covering(state, eyes, places)
            for name, eye in eyes.items():
                covering, clear = drawn.covering(eye, point, posture), set(translucent[name])
                found = {"covered": covering, "hidden": covering - clear}
                found |= {"needless": clear - covering}
                counts[name].update(["views", *(kind for kind in found if found[kind])])
    return counts
