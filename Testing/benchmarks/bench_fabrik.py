"""FABRIK and pin-pink on the same seeded targets.

Cold starts go from the home pose to targets anywhere in reach; tracking follows a path of 1 mm
steps around the head. A time is the median of the runs of one target; Pinocchio judges success:
ours within 1 nm and inside the limits, pin-pink within 0.1 mm.
"""

import gc
import time
from collections.abc import Sequence
from typing import NamedTuple, Protocol

import numpy as np
import pinocchio as pin

from rastrainer_simulator.robot.fabrik import Fabrik
from rastrainer_simulator.robot.model import load_robot
from Testing.benchmarks.ik_peers import Pinocchio, PinPink
from Testing.benchmarks.row import row

MODES = ("position", "direction", "pose")
SEED = 2011
EXACT_M = 1e-9
EXACT_RAD = 1e-7
CLINICAL_BOX = ([0.35, -0.15, 0.15], [0.65, 0.15, 0.5])
STEP_M = 0.001
STEP_LIMIT = 0.15


class Sizes(NamedTuple):
    """How much is measured."""

    verified: int
    timed: int
    runs: int


class Solver(Protocol):
    """One way to solve inverse kinematics."""

    name: str

    def question(self, target: pin.SE3, mode: str) -> tuple:
        """Convert a target as this solver needs it; not part of its time."""

    def solve(self, question: tuple, q_start: Sequence[float]) -> Sequence[float] | None:
        """Return joint angles, or None."""


class Ours:
    """FABRIK, called as by the control loop: with plain floats."""

    name = "FABRIK"

    def __init__(self) -> None:
        model = load_robot()
        self.home = model.home
        self._fabrik = Fabrik(model)

    def question(self, target: pin.SE3, mode: str) -> tuple:
        direction = target.rotation[:, 2].tolist() if mode == "direction" else None
        rotation = target.rotation.tolist() if mode == "pose" else None
        return target.translation.tolist(), direction, rotation

    def solve(self, question: tuple, q_start: Sequence[float]) -> Sequence[float]:
        return self._fabrik.solve(*question, q_start=q_start).q


def rows(quick: bool = True) -> list[dict]:
    """Return `ik.<mode>.cold` and `ik.<mode>.track`, and the joints' steps."""
    sizes = Sizes(3_000, 200, 3) if quick else Sizes(100_000, 2_000, 5)
    robot, ours = Pinocchio(), Ours()
    peer = PinPink(robot)
    gc.collect()
    gc.freeze()  # as the server does
    try:
        cold = [_cold(robot, ours, peer, mode, sizes) for mode in MODES]
        track = [row for mode in MODES for row in _track(robot, ours, peer, mode, sizes)]
    finally:
        gc.unfreeze()
    return [*cold, *track]


def _cold(robot: Pinocchio, ours: Ours, peer: Solver, mode: str, sizes: Sizes) -> dict:
    random = np.random.default_rng(SEED)
    postures = random.uniform(*robot.limits, (sizes.verified, 7))
    targets = [robot.tip(q).copy() for q in postures]
    solved = 0
    for target in targets:
        q = ours.solve(ours.question(target, mode), ours.home)
        solved += _exact(robot, np.array(q), target, mode)
    success = solved / len(targets)
    few = targets[: sizes.timed]
    times = _cold_times(ours, few, mode, ours.home, sizes.runs)
    others = _cold_times(peer, few, mode, ours.home, sizes.runs)
    name, n = f"ik.{mode}.cold", len(targets)
    return row(name, times, "µs", peer.name, others, success=success, n=n)


def _track(robot: Pinocchio, ours: Ours, peer: Solver, mode: str, sizes: Sizes) -> list[dict]:
    targets = _path(sizes.timed)
    start = np.array(ours.solve(ours.question(targets[0], "direction"), ours.home))
    for target in targets:
        target.rotation = robot.tip(start).rotation
    times, postures = _track_times(ours, targets, mode, start, sizes.runs)
    success = np.mean(
        [
            _exact(robot, np.array(q), target, mode)
            for q, target in zip(postures, targets, strict=True)
        ]
    )
    others = _track_times(peer, targets, mode, start, sizes.runs)[0]
    found = [row(f"ik.{mode}.track", times, "µs", peer.name, others, success=float(success))]
    if mode == "position":
        steps = np.degrees(np.abs(np.diff(postures, axis=0)).max(axis=1))
        found.append(
            row("ik.position.step", steps, "°/mm", success=float((steps <= STEP_LIMIT).mean()))
        )
    return found


def _exact(robot: Pinocchio, q: np.ndarray, target: pin.SE3, mode: str) -> bool:
    off, turned = robot.errors(q, target, mode)
    inside = bool(np.all(np.clip(q, *robot.limits) == q))
    return inside and off <= EXACT_M and turned <= EXACT_RAD


def _path(count: int) -> list[pin.SE3]:
    """Return a walk of 1 mm steps between random points of a box around the head."""
    random = np.random.default_rng(SEED)
    low, high = CLINICAL_BOX
    point, goal, path = random.uniform(low, high), random.uniform(low, high), []
    while len(path) < count:
        rest = goal - point
        far = np.linalg.norm(rest)
        if far < STEP_M:
            goal = random.uniform(low, high)
            continue
        point = point + rest * (STEP_M / far)
        path.append(pin.SE3(np.diag([1.0, -1.0, -1.0]), point))
    return path


def _cold_times(
    solver: Solver, targets: list[pin.SE3], mode: str, home: Sequence[float], runs: int
) -> np.ndarray:
    """Return each target's time in µs, the median of the runs."""
    questions = [solver.question(target, mode) for target in targets]
    times = np.empty((runs, len(questions)))
    for run in range(runs):
        for index, question in enumerate(questions):
            begin = time.perf_counter_ns()
            solver.solve(question, home)
            times[run, index] = time.perf_counter_ns() - begin
    return np.median(times, axis=0) / 1000.0


def _track_times(
    solver: Solver, targets: list[pin.SE3], mode: str, start: Sequence[float], runs: int
) -> tuple[np.ndarray, list[Sequence[float]]]:
    """Return each step's time in µs, the median of the runs, and the postures."""
    questions = [solver.question(target, mode) for target in targets]
    times = np.empty((runs, len(questions)))
    for run in range(runs):
        postures = [start]
        for index, question in enumerate(questions):
            begin = time.perf_counter_ns()
            q = solver.solve(question, postures[-1])
            times[run, index] = time.perf_counter_ns() - begin
            postures.append(postures[-1] if q is None else q)
    return np.median(times, axis=0) / 1000.0, postures[1:]
