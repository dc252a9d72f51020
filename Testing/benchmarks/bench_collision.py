"""All clearances of a tick, compared with coal on the same shapes."""

import gc
import time
from collections.abc import Callable, Iterator
from itertools import islice

import coal
import numpy as np

from rastrainer import transforms
from rastrainer.head.mesh import read_head_mesh
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.collision import APART, Collision
from rastrainer_simulator.collision.robot_shape import ArmCapsules, PosedArm, load_shape
from rastrainer_simulator.collision.touch_planner import TouchPlanner
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.kinematics import make_kinematics
from Testing.benchmarks.row import row_of_figures

TICK = 0.004
TOUR_SPEED = 0.15
AGREEMENT = 5e-5
_THIN = 1e-6


class Bench:
    """The default scenario's robot and head, in its nominal pose."""

    def __init__(self) -> None:
        setup = load_setup()
        self.robot, self.scenario = setup.robot, setup.scenario
        mesh = read_head_mesh(setup.scenario.head)
        self.vertices, self.triangles = mesh.vertices / MM_PER_M, mesh.triangles
        self.to_world = setup.scenario.head_to_world.copy()
        self.to_world[:3, 3] /= MM_PER_M
        self.kinematics, self.fabrik = make_kinematics(self.robot), Fabrik(self.robot)

    def collision(self) -> Collision:
        found = Collision(load_shape(), self.vertices, self.triangles)
        found.set_head_pose(self.to_world)
        return found


def rows(quick: bool) -> list[dict]:
    """Return the row `clearance.60k`."""
    bench = Bench()
    collision, peer = bench.collision(), CoalArm(bench)
    tour = [
        bench.kinematics.links(q) for q in islice(_tour(bench, collision), 500 if quick else 3000)
    ]
    times = [_times(collision.check, tour) for _ in range(1 if quick else 5)]
    peer_times = _times(peer.check, tour[::10])
    agrees = []
    for links in tour[::10]:
        found, theirs = collision.check(links), peer.check(links)
        shaft = collision.nearest_to_shaft(links, np.inf).distance_m
        ours = (abs(found.tip_m), shaft, found.links_m, found.self_m)
        agrees.append(all(abs(a - b) < AGREEMENT for a, b in zip(ours, theirs, strict=True)))
    return [
        row_of_figures(
            "clearance.60k",
            np.median([np.percentile(run, [50, 99]) for run in times], axis=0),
            "ms",
            peer="coal, every pair",
            peer_figures=tuple(np.percentile(peer_times, [50, 99])),
            success=float(np.mean(agrees)),
            n=len(tour),
        )
    ]


def _tour(bench: Bench, collision: Collision) -> Iterator[np.ndarray]:
    """Yield joint angles tick by tick: from fiducial to fiducial, 50 mm above the skin between."""
    planner, q = TouchPlanner(bench.robot, collision), None
    for fiducial in np.concatenate([task.fiducials for task in bench.scenario.tasks]):
        position = transforms.apply(bench.to_world, fiducial / MM_PER_M)
        normal = np.array(collision.nearest_to_point(tuple(position)).normal)
        touch = planner.touch(position, normal)
        over = bench.fabrik.solve(position + 0.05 * normal, touch.direction, q_start=touch.q)
        q = np.array(over.q) if q is None else q
        for goal in (over.q, touch.q, over.q):
            length = np.linalg.norm(
                bench.kinematics.tip(goal)[:3, 3] - bench.kinematics.tip(q)[:3, 3]
            )
            ticks = max(1, int(length / (TOUR_SPEED * TICK)))
            yield from np.linspace(q, goal, ticks)
            q = np.array(goal)


def _times(check: Callable[[dict], object], tour: list[dict]) -> np.ndarray:
    """Return the time of each call in ms; the first, which knows nothing yet, is left out."""
    check(tour[0])
    gc.collect()
    gc.freeze()
    times = []
    for links in tour:
        start = time.perf_counter()
        check(links)
        times.append(1e3 * (time.perf_counter() - start))
    gc.unfreeze()
    return np.array(times)


class CoalArm:
    """The same shapes in coal, queried for every pair.

    It gets our trick too, thin capsules whose radius is subtracted: with their real radius it
    takes a hundred times longer.
    """

    def __init__(self, bench: Bench) -> None:
        vertices, triangles = bench.vertices, bench.triangles
        self._arm = ArmCapsules(load_shape())
        self._head = coal.BVHModelOBBRSS()
        self._head.beginModel(len(triangles), len(vertices))
        self._head.addVertices(np.asfortranarray(vertices))
        self._head.addTriangles(np.asfortranarray(triangles.astype(np.int32)))
        self._head.endModel()
        self._head_pose = coal.Transform3s(bench.to_world[:3, :3], bench.to_world[:3, 3])
        self._point = coal.Sphere(_THIN)
        self._radii = self._arm.radii.tolist()
        lengths = np.linalg.norm([c.end - c.start for c in self._arm.capsules], axis=1)
        self._capsules = [coal.Capsule(_THIN, length) for length in lengths]
        first, second = np.triu_indices(len(self._capsules), k=1)
        apart = np.abs(self._arm.joints[first] - self._arm.joints[second]) >= APART
        self._pairs = list(zip(first[apart].tolist(), second[apart].tolist(), strict=True))

    def check(self, links: dict) -> tuple[float, float, float, float]:
        posed = self._arm.pose(links)
        poses = [_pose_of(*axis) for axis in posed.ends]
        count = self._arm.link_count
        to_head = [
            self._to_head(capsule, pose) - radius
            for capsule, pose, radius in zip(self._capsules, poses, self._radii, strict=True)
        ]
        itself = min(
            self._distance(self._capsules[i], poses[i], self._capsules[j], poses[j])
            - self._radii[i]
            - self._radii[j]
            for i, j in self._pairs
        )
        return (
            self._to_head(self._point, _at(posed)),
            min(to_head[count:]),
            min(0.1, *to_head[:count]),
            min(0.1, itself),
        )

    def _to_head(self, shape: coal.ShapeBase, pose: coal.Transform3s) -> float:
        return self._distance(self._head, self._head_pose, shape, pose)

    @staticmethod
    def _distance(a, pose_a, b, pose_b) -> float:
        return coal.distance(a, pose_a, b, pose_b, coal.DistanceRequest(), coal.DistanceResult())


def _at(posed: PosedArm) -> coal.Transform3s:
    return coal.Transform3s(np.eye(3), np.array(posed.tip))


def _pose_of(start: np.ndarray, end: np.ndarray) -> coal.Transform3s:
    axis = end - start
    size = np.linalg.norm(axis)
    z = axis / size if size > 0.0 else np.array([0.0, 0.0, 1.0])
    x = np.cross(np.eye(3)[np.abs(z).argmin()], z)
    x /= np.linalg.norm(x)
    return coal.Transform3s(np.column_stack([x, np.cross(z, x), z]), (start + end) / 2.0)
