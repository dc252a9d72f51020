"""Any 7R S-R-S arm is accepted, whatever its lengths, limits and conventions."""

import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.kinematics import make_kinematics
from rastrainer_simulator.robot.model import load_robot

Z, Y = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])


def write_arm(path, joints, tip, limits, digits=17, base=None, kind="revolute"):
    """Write a URDF from the joints' frames (4, 4) at q = 0 in World and their axes there."""
    base = np.eye(4) if base is None else base
    lines = ['<robot name="other"><link name="world"/>']
    before = np.eye(4)

    def add(name, kind, parent, pose, extra=""):
        nonlocal before
        local = np.linalg.inv(before) @ pose
        xyz = " ".join(f"{value:.{digits}g}" for value in local[:3, 3])
        turns = Rotation.from_matrix(local[:3, :3]).as_euler("xyz")
        rpy = " ".join(f"{value:.{digits}g}" for value in turns)
        lines.append(
            f'<link name="{name}"/><joint name="to_{name}" type="{kind}"><parent link="{parent}"/>'
            f'<child link="{name}"/><origin xyz="{xyz}" rpy="{rpy}"/>{extra}</joint>'
        )
        before = pose

    add("base", "fixed", "world", base)
    for number, (frame, axis) in enumerate(joints, start=1):
        pose = base @ frame
        direction = " ".join(f"{value:.17g}" for value in frame[:3, :3].T @ axis)
        lower, upper = limits[number - 1]
        extra = (
            f'<axis xyz="{direction}"/>'
            f'<limit lower="{lower:.17g}" upper="{upper:.17g}" velocity="2" effort="100"/>'
        )
        pan = number % 2 == 1
        parent = "base" if number == 1 else f"link_{number - 1}"
        add(f"link_{number}", kind if pan else "revolute", parent, pose, extra)
    add("needle", "fixed", "link_7", base @ tip)
    path.write_text("".join(lines) + "</robot>", encoding="utf-8")
    return path


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


def random_arm(path, seed):
    """Write an arm with random lengths, zero pose, signs, limits, and frames turned at will."""
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
    return write_arm(path, joints, tip, limits, base=base)


def check_every_mode(robot, count, seed, tolerance=1e-9):
    kinematics, fabrik = make_kinematics(robot), Fabrik(robot)
    tool_axis = robot.geometry.tip_rotation[2]
    random = np.random.default_rng(seed)
    lower, upper = np.maximum(robot.lower, -20.0), np.minimum(robot.upper, 20.0)
    for q in random.uniform(lower, upper, (count, 7)):
        goal = kinematics.tip(q)
        direction = goal[:3, :3] @ tool_axis
        for mode in ((), (direction,), (None, goal[:3, :3])):
            solution = fabrik.solve(goal[:3, 3], *mode, q_start=robot.home)
            reached = kinematics.tip(solution.q)
            assert solution.converged, solution
            assert np.linalg.norm(reached[:3, 3] - goal[:3, 3]) <= tolerance
            assert np.all(robot.lower <= solution.q)
            assert np.all(solution.q <= robot.upper)
            if mode:
                np.testing.assert_allclose(reached[:3, :3] @ tool_axis, direction, atol=1e-7)
            if len(mode) == 2:
                np.testing.assert_allclose(reached[:3, :3], goal[:3, :3], atol=1e-7)


@pytest.mark.parametrize("seed", range(8))
def test_an_arm_of_random_lengths_and_conventions_is_solved_in_every_mode(tmp_path, seed):
    check_every_mode(load_robot(random_arm(tmp_path / "arm.urdf", seed)), 150, seed)


def test_an_arm_with_all_tilts_about_plus_y_is_solved(tmp_path):
    centers, axes, tip = chain_at([0.0] * 7, (0.36, 0.42, 0.40, 0.25))
    joints = [(translation(center), axis) for center, axis in zip(centers, axes, strict=True)]
    limits = symmetric(170, 120, 170, 120, 170, 120, 175)
    robot = load_robot(write_arm(tmp_path / "arm.urdf", joints, tip, limits))
    assert robot.geometry.signs == (1.0,) * 7
    check_every_mode(robot, 150, 1)


def test_an_arm_whose_first_axis_points_down_is_solved(tmp_path):
    centers, axes, tip = chain_at([0.0] * 7, (0.36, 0.42, 0.40, 0.25))
    axes[0] = -axes[0]
    joints = [(translation(center), axis) for center, axis in zip(centers, axes, strict=True)]
    limits = symmetric(170, 120, 170, 120, 170, 120, 175)
    check_every_mode(load_robot(write_arm(tmp_path / "arm.urdf", joints, tip, limits)), 100, 1)


def test_an_arm_with_axis_aligned_frames_and_rounded_angles_is_solved(tmp_path):
    centers, _, tip = chain_at([0.0] * 7, (0.34, 0.40, 0.40, 0.30))
    turned = Rotation.from_euler("x", -90, degrees=True).as_matrix()
    joints = []
    for index, center in enumerate(centers):
        frame = translation(center)
        if index % 2:
            frame[:3, :3] = turned
        joints.append((frame, frame[:3, 2]))
    limits = symmetric(170, 120, 170, 120, 170, 120, 175)
    robot = load_robot(write_arm(tmp_path / "arm.urdf", joints, tip, limits, digits=5))
    assert robot.geometry.misfit > 1e-7
    check_every_mode(robot, 100, 2)


def test_an_arm_with_continuous_pan_joints_and_a_one_sided_elbow_is_solved(tmp_path):
    centers, axes, tip = chain_at([0.0] * 7, (0.28, 0.42, 0.31, 0.17))
    joints = [(translation(center), axis) for center, axis in zip(centers, axes, strict=True)]
    limits = symmetric(170, 128, 170, 147, 170, 120, 170)
    limits[3] = (0.0, math.radians(147))
    path = write_arm(tmp_path / "arm.urdf", joints, tip, limits, kind="continuous")
    check_every_mode(load_robot(path), 100, 3)
