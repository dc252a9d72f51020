"""The tool stops at the head, slides along it, and nothing is refused that could be touched."""

from itertools import islice

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.head.mesh import read_head_mesh
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.collision.contact import REST
from rastrainer_simulator.collision.touch_planner import TouchPlanner
from Testing.simulator.collision.brute_force import vtk_distance
from Testing.simulator.collision.heads_and_arms import (
    KINEMATICS,
    ROBOT,
    SHAPE,
    TICK,
    Driver,
    at,
    ball,
    box,
    posture,
    together,
)

DEEPEST = 1e-4
TOUCHING = 5e-5
DOWN = np.array([0.0, 0.0, -1.0])


def collision_with(surface, center):
    found = Collision(SHAPE, *surface, stand_radius=0.0)
    found.set_head_pose(at(surface[0], center))
    return found


def above(surface, center, x=0.0, y=0.0, height=0.02):
    """A driver with the tool straight down, `height` over the top of a surface."""
    top = center[2] + np.ptp(surface[0][:, 2]) / 2.0
    q = posture((center[0] + x, center[1] + y, top + height), DOWN)
    return Driver(collision_with(surface, center), q)


class DefaultHead:
    """The head of the default scenario, where it stands, and VTK's distance to it."""

    def __init__(self, scenario):
        mesh = read_head_mesh(scenario.head)
        self.to_world = scenario.head_to_world.copy()
        self.to_world[:3, 3] /= MM_PER_M
        self.vertices = transforms.apply(self.to_world, mesh.vertices / MM_PER_M)
        self.triangles = mesh.triangles
        self.normals = mesh.vertex_normals @ self.to_world[:3, :3].T
        self.collision = Collision(SHAPE, mesh.vertices / MM_PER_M, mesh.triangles)
        self.collision.set_head_pose(self.to_world)
        self.distance = vtk_distance(self.vertices, mesh.triangles)

    def hollows(self, count):
        """The vertices farthest below their neighbors: ears, eyes, nostrils, lips."""
        sides = np.concatenate([self.triangles[:, [0, 1]], self.triangles[:, [1, 2]]])
        rise = np.zeros(len(self.vertices))
        for a, b in (sides.T, sides.T[::-1]):
            step = self.vertices[b] - self.vertices[a]
            slope = np.einsum("ij,ij->i", step, self.normals[a]) / np.linalg.norm(step, axis=1)
            np.add.at(rise, a, slope)
        rise[self.vertices[:, 2] < self.vertices[:, 2].min() + 0.03] = -np.inf
        return np.argsort(rise)[-count:]


@pytest.fixture(scope="module")
def head(scenario):
    return DefaultHead(scenario)


def approaches(head, vertices, random):
    """Starting postures 20 mm before some vertices, leaning, that touch nothing yet."""
    for vertex in np.repeat(vertices, 3):
        direction = -head.normals[vertex] + 0.4 * random.normal(size=3)
        direction /= np.linalg.norm(direction)
        q = posture(head.vertices[vertex] - 0.02 * direction, direction)
        if q is None:
            continue
        found = head.collision.check(KINEMATICS.links(q))
        if min(found.tool_m, found.links_m, found.self_m, found.table_m) > 0.001:
            yield q, direction


@pytest.mark.parametrize(
    ("holds", "count"), [(True, 20), pytest.param(False, 70, marks=pytest.mark.soak)]
)
def test_ramming_at_full_speed_from_all_sides_never_penetrates(head, holds, count):
    random = np.random.default_rng(41)
    high = np.flatnonzero(head.vertices[:, 2] > head.vertices[:, 2].min() + 0.03)
    places = random.permutation([*random.choice(high, 100), *head.hollows(1500)[::15]])
    touched, deepest = 0, 0.0
    for q, direction in islice(approaches(head, places, random), count):
        driver = Driver(head.collision, q, holds)
        speed, aside = random.uniform(0.25, 0.5), random.normal(size=3)
        for tick in range(40):
            push = direction if tick < 25 else direction + 0.5 * aside
            driver.push(push / np.linalg.norm(push) * speed * TICK)
            deepest = min(deepest, driver.clearance.shaft_m, head.distance(driver.tip))
            touched += tick == 24 and driver.clearance.tool_m < TOUCHING
    assert touched >= 0.92 * count
    assert deepest >= -DEEPEST


def test_every_fiducial_of_the_default_tasks_can_be_touched_with_the_tip(head, scenario):
    planner = TouchPlanner(ROBOT, head.collision)
    for task in scenario.tasks:
        fiducials = transforms.apply(head.to_world, np.asarray(task.fiducials) / MM_PER_M)
        for fiducial in fiducials[::7]:
            normal = np.array(head.collision.nearest_to_point(tuple(fiducial)).normal)
            touch = planner.touch(fiducial, normal)
            assert touch is not None
            driver = Driver(head.collision, touch.q)
            for _ in range(10):
                driver.push(normal * 0.25 * TICK)
            for _ in range(15):
                offset = fiducial - driver.tip
                driver.push(offset * min(1.0, 0.25 * TICK / np.linalg.norm(offset)))
            assert np.linalg.norm(driver.tip - fiducial) <= TOUCHING + 2 * REST
            assert driver.clearance.tip_m <= TOUCHING


def test_a_tip_at_full_speed_does_not_jump_through_a_thin_plate():
    plate = together(box((0.1, 0.1, 0.001), (0.0, 0.0, 0.0)), ball(0.02, 2))
    plate[0][8:] += [0.0, 0.0, -0.1]
    collision, top = collision_with(plate, (0.5, 0.0, 0.25)), 0.25 + np.ptp(plate[0][:, 2]) / 2.0
    for speed in (0.25, 0.37, 0.5):
        for offset in np.linspace(0.0, 2e-3, 7):
            driver = Driver(collision, posture((0.52, 0.0, top + 0.01 + offset), DOWN))
            for _ in range(20):
                driver.push(DOWN * speed * TICK)
                assert driver.tip[2] >= top


def test_a_link_in_the_way_stops_the_arm_and_is_named():
    q = posture((0.6, 0.0, 0.4), DOWN)
    forearm = KINEMATICS.links(q)["iiwa_link_5"] @ [0.0, -0.06, 0.1, 1.0]
    collision = collision_with(ball(0.03, 4), forearm[:3] - [0.05, 0.0, 0.15])
    driver = Driver(collision, q)
    for _ in range(200):
        driver.push(DOWN * 0.3 * TICK)
        assert driver.clearance.links_m >= 0.0
    assert driver.moved.stopped_by == "links"
    held = driver.tip
    for _ in range(20):
        driver.push(-DOWN * 0.3 * TICK)
    assert driver.tip[2] > held[2] + 0.01


def test_a_tool_inside_a_newly_placed_head_can_move_out_but_never_deeper():
    surface = ball(0.08, 4)
    collision = collision_with(surface, (0.5, 0.0, 0.2))
    driver = Driver(collision, posture((0.5, 0.0, 0.27), DOWN))
    depth = driver.clearance.tip_m
    assert depth < -0.005
    for _ in range(10):
        driver.push(DOWN * 0.25 * TICK)
        assert driver.clearance.tip_m >= depth - 1e-6
        depth = driver.clearance.tip_m
    for _ in range(200):
        driver.push(-DOWN * 0.25 * TICK)
    assert driver.clearance.tip_m > 0.1


def test_the_same_pushes_give_the_same_joints_to_the_last_bit(head):
    def played():
        random = np.random.default_rng(42)
        q, direction = next(approaches(head, [*head.hollows(50)], random))
        driver = Driver(head.collision, q)
        for _ in range(120):
            push = direction + 0.6 * random.normal(size=3)
            driver.push(push * 0.4 * TICK)
            yield driver.moved.q

    assert list(played()) == list(played())
