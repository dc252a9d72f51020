"""The joints follow the tip exactly, within limits, and do not wander."""

import numpy as np
import pytest

from rastrainer_simulator.core.arm import JointMotion, start_joints
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.vectors import unit

DT = 0.004
SPEED = 0.12


@pytest.fixture(scope="module")
def rest(setup):
    return start_joints(setup.robot, setup.scenario, setup.settings.start_height)


@pytest.fixture(scope="module")
def motion(setup, rest):
    return JointMotion(setup.robot, rest)


@pytest.fixture(scope="module")
def kinematics(setup):
    return make_kinematics(setup.robot)


def tip(kinematics, q):
    return tuple(kinematics.tip(q)[:3, 3].tolist())


def go(motion, kinematics, q, target, direction=None):
    """Return the joint angles after a straight motion of the tip."""
    target = np.array(target)
    while (remaining := target - tip(kinematics, q)) @ remaining > 1e-16:
        step = remaining * min(1.0, SPEED * DT / np.linalg.norm(remaining))
        q, _ = motion.toward(q, tip(kinematics, q), tuple(step.tolist()), direction, DT)
    return q


def test_the_elbow_does_not_wander_on_closed_paths(motion, kinematics, rest):
    start = np.array(tip(kinematics, rest))
    q = rest
    for _ in range(3):
        for corner in ((0.15, 0.0, 0.0), (0.15, 0.2, 0.1), (0.0, 0.2, 0.1), (0.0, 0.0, 0.0)):
            q = go(motion, kinematics, q, start + corner)
    assert np.degrees(np.abs(np.subtract(q, rest)).max()) < 8.0


def test_where_a_joint_is_too_slow_the_tip_stays_on_its_straight_path(
    motion, kinematics, rest, setup
):
    start = np.array(tip(kinematics, rest))
    q, _ = motion.toward(rest, tuple(start), (0.1, -0.05, 0.0), unit((1.0, 0.0, -0.2)), DT)
    moved = np.array(tip(kinematics, q)) - start
    along = unit((0.1, -0.05, 0.0))
    assert moved @ along > 0.0
    assert np.linalg.norm(moved - (moved @ along) * np.array(along)) < 2e-5
    assert (np.abs(np.subtract(q, rest)) <= setup.robot.velocity * DT * (1 + 1e-9)).all()
