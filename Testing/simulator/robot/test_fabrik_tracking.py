"""FABRIK along paths of one-millimeter steps, as teleoperation asks for them."""

import numpy as np
import pytest

from rastrainer_simulator.core.arm import limit_step
from rastrainer_simulator.robot.kinematics import make_kinematics

TICK = 0.004
STEP = 0.001
CLINICAL_BOX = ([0.35, -0.15, 0.15], [0.65, 0.15, 0.5])
DOWN = [0.0, 0.0, -1.0]


def wander(box, count, seed):
    """Return a path (count, 3) in steps of 1 mm from one random point of a box to the next."""
    random = np.random.default_rng(seed)
    point, goal, path = random.uniform(*box), random.uniform(*box), []
    while len(path) < count:
        rest = goal - point
        far = np.linalg.norm(rest)
        if far < STEP:
            goal = random.uniform(*box)
            continue
        point = point + rest * (STEP / far)
        path.append(point)
    return np.array(path)


def straight(start, end):
    start, end = np.array(start, float), np.array(end, float)
    count = round(np.linalg.norm(end - start) / STEP)
    return start + np.linspace(0.0, 1.0, count + 1)[:, None] * (end - start)


def track(fabrik, path, q, direction=None, rotation=None):
    """Return each joint's step in degrees, and each solution, along a path."""
    steps, solutions = [], []
    for position in path:
        solution = fabrik.solve(position, direction, rotation, q_start=q)
        steps.append(np.degrees(np.abs(np.subtract(solution.q, q))))
        solutions.append(solution)
        q = solution.q
    return np.array(steps), solutions


def test_in_the_clinical_box_no_joint_turns_more_than_0_15_degrees_per_millimeter(fabrik, robot):
    path = wander(CLINICAL_BOX, 1000, seed=1)
    start = fabrik.solve(path[0], DOWN, q_start=robot.home)
    steps, solutions = track(fabrik, path, start.q)
    assert all(solution.converged for solution in solutions)
    assert steps.max() <= 0.15


def test_with_the_direction_held_the_arm_follows_exactly_and_without_jumps(fabrik, robot):
    low, high = CLINICAL_BOX
    path = wander((low, [high[0], high[1], 0.42]), 1000, seed=2)
    start = fabrik.solve(path[0], DOWN, q_start=robot.home)
    kinematics = make_kinematics(robot)
    steps, solutions = track(fabrik, path, start.q, DOWN)
    assert all(solution.converged for solution in solutions)
    assert steps.max() <= 1.0
    for solution in solutions[::100]:
        np.testing.assert_allclose(kinematics.tip(solution.q)[:3, 2], DOWN, atol=1e-8)


@pytest.mark.parametrize(
    ("mode", "beside"), [("position", 0.003), ("direction", 1e-4), ("pose", 0.0)]
)
def test_the_wrist_passes_over_the_shoulder_smoothly(fabrik, robot, mode, beside):
    path = straight([0.326 + beside, -0.3, 0.9], [0.326 + beside, 0.3, 0.9])
    forward = [1.0, 0.0, 0.0]
    start = fabrik.solve(path[0], forward, q_start=robot.home)
    rotation = make_kinematics(robot).tip(start.q)[:3, :3] if mode == "pose" else None
    held = forward if mode == "direction" else None
    steps, solutions = track(fabrik, path, start.q, held, rotation)
    assert all(solution.converged for solution in solutions)
    assert steps.max() <= 0.5


@pytest.mark.parametrize("direction", [None, [1.0, 0.0, 0.0]])
def test_the_arm_stretches_to_its_limit_stays_there_and_comes_back(fabrik, robot, direction):
    out = straight([0.95, 0.05, 0.34], [1.2, 0.05, 0.34])
    start = fabrik.solve(out[0], [1.0, 0.0, 0.0], q_start=robot.home)
    steps, solutions = track(fabrik, np.vstack((out, out[::-1])), start.q, direction)
    path = np.vstack((out, out[::-1]))
    wrist = path - [0.326, 0.0, 0.34] if direction else path - [0.0, 0.0, 0.34]
    beyond = np.linalg.norm(wrist, axis=1) > (0.8 if direction else 1.126)
    assert [not solution.converged for solution in solutions] == beyond.tolist()
    # At the edge itself angles grow with the square root of the distance: no solver can do less.
    edge = np.abs(np.linalg.norm(wrist, axis=1) - (0.8 if direction else 1.126)) < 0.008
    assert steps[edge].max() <= 45.0
    assert steps[~edge].max() <= 2.0


def test_joint_speeds_stay_within_limits_on_wide_paths_past_singularities_and_edges(fabrik, robot):
    path = wander(([-0.9, -0.9, -0.1], [0.9, 0.9, 1.4]), 1500, seed=3)
    q = fabrik.solve(path[0], q_start=robot.home).q
    most = robot.velocity * TICK
    waited = reached = 0
    for position in path:
        solution = fabrik.solve(position, q_start=q)
        moved_to, has_waited = limit_step(q, solution.q, robot.velocity, TICK)
        moved = np.abs(np.subtract(moved_to, q))
        assert np.all(moved <= most * (1.0 + 1e-9))
        assert np.degrees(moved).max() <= 2.0
        assert np.all(np.clip(moved_to, *robot.limits) == moved_to)
        waited += has_waited
        reached += solution.converged and not has_waited
        q = moved_to
    assert waited < 0.2 * len(path)
    assert reached > 0.6 * len(path)
