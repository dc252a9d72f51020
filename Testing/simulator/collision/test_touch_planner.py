import numpy as np
import pytest

from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.collision.robot_shape import load_shape
from rastrainer_simulator.collision.touch_planner import TouchPlanner
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import load_robot
from Testing.simulator.collision.heads_and_arms import ball

CENTER = np.array([0.50, 0.0, 0.30])
RADIUS = 0.08
OUTWARD = {"top": (0.0, 0.0, 1.0), "front": (0.0, -0.9, 0.44), "far side": (0.8, 0.0, 0.6)}


@pytest.fixture(scope="module")
def robot():
    return load_robot()


@pytest.fixture(scope="module")
def collision():
    collision = Collision(load_shape(), *ball(RADIUS))
    pose = np.eye(4)
    pose[:3, 3] = CENTER
    collision.set_head_pose(pose)
    return collision


@pytest.fixture(scope="module")
def planner(robot, collision):
    return TouchPlanner(robot, collision)


@pytest.mark.parametrize("place", OUTWARD)
def test_in_a_touch_only_the_tip_is_at_the_skin_and_the_tool_leans_as_stated(
    robot, collision, planner, place
):
    normal = np.array(OUTWARD[place]) / np.linalg.norm(OUTWARD[place])
    position = CENTER + RADIUS * normal
    touch = planner.touch(position, normal)
    kinematics = make_kinematics(robot)
    assert np.allclose(kinematics.tip(touch.q)[:3, 3], position, atol=1e-8)
    assert np.all(np.array(touch.q) >= robot.limits[0])
    assert np.all(np.array(touch.q) <= robot.limits[1])
    leaning = np.degrees(np.arccos(min(-touch.direction @ normal, 1.0)))
    assert leaning == pytest.approx(touch.leaning_deg, abs=1e-3)
    found = collision.check(kinematics.links(touch.q))
    assert found.shaft_m > 0
    assert min(found.links_m, found.self_m, found.table_m) >= 0.005
