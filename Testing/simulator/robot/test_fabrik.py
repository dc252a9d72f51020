"""FABRIK's answers, checked by Pinocchio."""

import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest

from rastrainer.errors import InputError
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.model import LENGTHS_M, load_robot
from rastrainer_simulator.robot.srs_arm import CanonicalArm

MODES = ("position", "direction", "pose")
SHOULDER = np.array([0.0, 0.0, 0.34])
REACH = 1.126
UPPER, FORE, TOOL = 0.4, 0.4, 0.326


class Truth:
    """Pinocchio's own reading of the URDF."""

    def __init__(self):
        self.model = pin.buildModelFromUrdf(str(asset_path("robots", "iiwa7", "iiwa7.urdf")))
        self.data = self.model.createData()
        self.frame = self.model.getFrameId("iiwa_tool_tip_ee")

    def tip(self, q):
        pin.forwardKinematics(self.model, self.data, np.asarray(q, float))
        return pin.updateFramePlacement(self.model, self.data, self.frame).homogeneous

    def postures(self, count, seed):
        random = np.random.default_rng(seed)
        low, high = self.model.lowerPositionLimit, self.model.upperPositionLimit
        return random.uniform(low, high, (count, 7))

    def inside(self, q):
        return np.all(self.model.lowerPositionLimit <= q) and np.all(
            q <= self.model.upperPositionLimit
        )


@pytest.fixture(scope="module")
def truth():
    return Truth()


def target(tip, mode):
    """Return the arguments of `solve` in a mode."""
    direction = tip[:3, 2] if mode == "direction" else None
    return tip[:3, 3], direction, tip[:3, :3] if mode == "pose" else None


@pytest.mark.parametrize("mode", MODES)
def test_every_reachable_target_is_reached_to_a_nanometer_within_the_limits(fabrik, truth, mode):
    starts = truth.postures(150, seed=4)
    for q, q_start in zip(truth.postures(150, seed=3), starts, strict=True):
        goal = truth.tip(q)
        solution = fabrik.solve(*target(goal, mode), q_start=q_start)
        reached = truth.tip(solution.q)
        assert solution.converged
        assert solution.reason == ""
        assert truth.inside(solution.q)
        assert np.linalg.norm(reached[:3, 3] - goal[:3, 3]) <= 1e-9
        if mode == "direction":
            np.testing.assert_allclose(reached[:3, 2], goal[:3, 2], atol=1e-9)
        if mode == "pose":
            np.testing.assert_allclose(reached[:3, :3], goal[:3, :3], atol=1e-9)


def test_the_branch_closest_to_the_previous_posture_is_chosen(fabrik, truth):
    for q in truth.postures(100, seed=7):
        goal = truth.tip(q)
        solution = fabrik.solve(*target(goal, "pose"), q_start=q + 1e-3)
        np.testing.assert_allclose(solution.q, q, atol=0.05)


@pytest.mark.parametrize(
    ("position", "nearest"),
    [
        ([-2.0, 2.0, 0.84], SHOULDER + REACH * np.array([-2, 2, 0.5]) / 8.25**0.5),
        # The upper arm is at the edge of its cone, and the rest points straight to the target.
        ([0.0, 1.0, -1.5], None),
    ],
)
def test_a_target_out_of_reach_is_approached_as_closely_as_the_arm_can(
    fabrik, robot, truth, position, nearest
):
    solution = fabrik.solve(position, q_start=robot.home)
    assert not solution.converged
    assert "out of reach" in solution.reason
    if nearest is None:
        elbow = SHOULDER + UPPER * np.array([0, math.sin(2 * math.pi / 3), -0.5])
        along = np.array(position) - elbow
        nearest = elbow + (FORE + TOOL) * along / np.linalg.norm(along)
    np.testing.assert_allclose(truth.tip(solution.q)[:3, 3], nearest, atol=1e-9)


def test_the_direction_is_kept_when_the_tool_falls_short_of_its_target(fabrik, robot, truth):
    down = [0.0, 0.0, -1.0]
    solution = fabrik.solve([0.9, 0.2, 0.3], down, q_start=robot.home)
    assert "out of reach" in solution.reason
    assert solution.direction_error_rad <= 1e-9
    wrist = np.array([0.9, 0.2, 0.3 + TOOL]) - SHOULDER
    off = np.linalg.norm(wrist) - (UPPER + FORE)
    assert solution.position_error_m == pytest.approx(off, abs=1e-9)
    np.testing.assert_allclose(truth.tip(solution.q)[:3, 2], down, atol=1e-9)


def test_a_roll_beyond_the_limits_is_given_up_but_not_position_and_direction(truth):
    whole = load_robot()
    joints = (*whole.joints[:6], replace(whole.joints[6], lower=-0.1, upper=0.1))
    arm = CanonicalArm.of(*LENGTHS_M, whole.arm.signs, joints)
    robot = replace(whole, joints=joints, arm=arm)
    fabrik = Fabrik(robot)
    forbidden = 0
    for q in truth.postures(100, seed=10):
        goal = truth.tip(q)
        solution = fabrik.solve(*target(goal, "pose"), q_start=robot.home)
        assert abs(solution.q[6]) <= 0.1
        assert solution.position_error_m <= 1e-9
        np.testing.assert_allclose(truth.tip(solution.q)[:3, 2], goal[:3, 2], atol=1e-9)
        if not solution.converged:
            forbidden += 1
            assert "roll" in solution.reason
            assert solution.direction_error_rad > 1e-3
    assert forbidden > 20


@pytest.mark.parametrize(
    "degrees",
    [
        (0, 0, 0, 0, 0, 0, 0),  # straight up: every pan in line
        (30, 60, 0, 0, 0, 0, 0),  # stretched
        (0, 0, 40, -90, 0, 60, 0),  # upper arm on the first axis
        (20, 30, 0, -90, 50, 0, 10),  # tool in line with the forearm
        (0, 0, 0, -90, 0, 0, 0),
        (0, -45, 0, -90, 0, 45, 0),  # wrist over the shoulder
        (170, 120, -170, -120, 170, 120, 175),  # every joint at a limit
    ],
)
@pytest.mark.parametrize("mode", MODES)
def test_singular_postures_are_held_and_left_without_a_jump(fabrik, truth, mode, degrees):
    q = np.radians(degrees)
    goal = truth.tip(q)
    held = fabrik.solve(*target(goal, mode), q_start=q)
    assert held.converged
    np.testing.assert_allclose(held.q, q, atol=1e-6)


def test_an_invalid_target_is_refused_in_one_sentence(fabrik, robot):
    place = [0.5, 0.1, 0.3]
    for arguments, sentence in (
        (([0.5, math.nan, 0.3],), "position must be three finite numbers"),
        ((place, [0, 0, 0]), "a finite vector with a length"),
        ((place, None, np.diag([1, 1, -1])), "perpendicular unit vectors"),
    ):
        with pytest.raises(InputError, match=sentence):
            fabrik.solve(*arguments, q_start=robot.home)
