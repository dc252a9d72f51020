"""Any 7R S-R-S arm is accepted, whatever its lengths, limits and conventions."""

import math
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import robot_model

Z, Y = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])


def arm(joints, tip, limits, base=None):
    """Return a robot of the joints' frames (4, 4) at q = 0 in World and their axes there."""
    before, rows = np.eye(4), []
    base = np.eye(4) if base is None else base
    for (frame, axis), (lower, upper) in zip(joints, limits, strict=True):
        pose = base @ frame
        rows.append(
            {
                "name": f"joint_{len(rows) + 1}",
                "origin": np.linalg.inv(before) @ pose,
                "axis": frame[:3, :3].T @ axis,
                "lower": lower,
                "upper": upper,
                "velocity": 2.0,
            }
        )
        before = pose
    names = [
        {"name": f"link_{number}", "joint": number, "offset": np.eye(4)} for number in range(8)
    ]
    needle = {"name": "needle", "joint": 7, "offset": np.linalg.inv(before) @ base @ tip}
    value = {"name": "other", "joints": rows, "links": [*names, needle], "tip": "needle"}
    return robot_model({**value, "meshes": []}, Path())


def chain_at(angles, lengths):
    """Return centers and axes of a straight S-R-S arm turned to `angles`, and its tip."""
    pose, centers, axes = np.eye(4), [], []
    pose[2, 3] = lengths[0]
    for index, angle in enumerate(angles):
        axis = Y if index % 2 else Z
        if index in (3, 5):
            pose = pose @ translation(lengths[(index - 1) // 2] * Z)
        centers.append(pose[:3, 3].copy())
        axes.append(pose[:3, :3] @ axis)
        turn = np.eye(4)
        turn[:3, :3] = Rotation.from_rotvec(angle * axis).as_matrix()
        pose = pose @ turn
    return centers, axes, pose @ translation(lengths[3] * Z)


def translation(vector):
    pose = np.eye(4)
    pose[:3, 3] = vector
    return pose


def symmetric(*degrees):
    return [(-math.radians(value), math.radians(value)) for value in degrees]


def random_arm(seed):
    """Return an arm with random lengths, zero pose, signs, limits, and frames turned at will."""
    random = np.random.default_rng(seed)
    lengths = random.uniform([0.1, 0.2, 0.2, 0.15], [0.6, 0.6, 0.6, 0.5])
    zero = random.uniform(-1.0, 1.0, 7)
    centers, axes, tip = chain_at(zero, lengths)
    joints, limits = [], []
    for index, (center, axis) in enumerate(zip(centers, axes, strict=True)):
        sign = random.choice([-1.0, 1.0])
        frame = np.eye(4)
        frame[:3, :3] = Rotation.random(rng=random).as_matrix()
        frame[:3, 3] = center + random.uniform(-0.1, 0.1) * axis
        joints.append((frame, sign * axis))
        reach = random.uniform(1.7, 2.2) if index % 2 else random.uniform(2.9, 3.1)
        ends = sorted((sign * (-reach - zero[index]), sign * (reach - zero[index])))
        limits.append(tuple(ends))
    tip[:3, :3] = Rotation.random(rng=random).as_matrix()
    base = translation(random.uniform(-1.0, 1.0, 3))
    base[:3, :3] = Rotation.random(rng=random).as_matrix()
    return arm(joints, tip, limits, base)


def check_every_mode(robot, count, seed, tolerance=1e-9):
    kinematics, fabrik = make_kinematics(robot), Fabrik(robot)
    tool_axis = robot.geometry.tip_rotation[2]
    random = np.random.default_rng(seed)
    lower, upper = robot.geometry.q_lower, robot.geometry.q_upper
    for q in random.uniform(lower, upper, (count, 7)):
        goal = kinematics.tip(q)
        direction = goal[:3, :3] @ tool_axis
        for mode in ((), (direction,), (None, goal[:3, :3])):
            solution = fabrik.solve(goal[:3, 3], *mode, q_start=robot.home)
            reached = kinematics.tip(solution.q)
            assert solution.converged, solution
            assert np.linalg.norm(reached[:3, 3] - goal[:3, 3]) <= tolerance
            assert np.all(np.clip(solution.q, lower, upper) == solution.q)
            if mode:
                np.testing.assert_allclose(reached[:3, :3] @ tool_axis, direction, atol=1e-7)
            if len(mode) == 2:
                np.testing.assert_allclose(reached[:3, :3], goal[:3, :3], atol=1e-7)


@pytest.mark.parametrize("seed", range(8))
def test_an_arm_of_random_lengths_and_conventions_is_solved_in_every_mode(seed):
    check_every_mode(random_arm(seed), 150, seed)


def test_an_arm_with_all_tilts_about_plus_y_is_solved():
    centers, axes, tip = chain_at([0.0] * 7, (0.36, 0.42, 0.40, 0.25))
    joints = [(translation(center), axis) for center, axis in zip(centers, axes, strict=True)]
    limits = symmetric(170, 120, 170, 120, 170, 120, 175)
    robot = arm(joints, tip, limits)
    assert robot.geometry.signs == (1.0,) * 7
    check_every_mode(robot, 150, 1)


def test_an_arm_whose_first_axis_points_down_is_solved():
    centers, axes, tip = chain_at([0.0] * 7, (0.36, 0.42, 0.40, 0.25))
    axes[0] = -axes[0]
    joints = [(translation(center), axis) for center, axis in zip(centers, axes, strict=True)]
    limits = symmetric(170, 120, 170, 120, 170, 120, 175)
    check_every_mode(arm(joints, tip, limits), 100, 1)


def test_an_arm_with_wide_pan_joints_and_a_one_sided_elbow_is_solved():
    centers, axes, tip = chain_at([0.0] * 7, (0.28, 0.42, 0.31, 0.17))
    joints = [(translation(center), axis) for center, axis in zip(centers, axes, strict=True)]
    limits = symmetric(900, 128, 900, 147, 900, 120, 900)
    limits[3] = (0.0, math.radians(147))
    check_every_mode(arm(joints, tip, limits), 100, 3)
