"""Measures how well a client can find the head's pose in the 60 s of a trial, by our best fit.

`python -m Testing.security.pose_leak` prints the table of `docs/openigtlink.md`. The client knows
the scenario and the exact pose of the tip, moves the arm as it likes, and reads what a row names.
A reading bounds the distance of the tip to the skin; the fit is the middle of the poses that agree
with all of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares, linprog
from scipy.spatial.transform import Rotation

from rastrainer import transforms
from rastrainer.head.mesh import outward_normals, read_head_mesh
from rastrainer.motion.trajectory import NEAR_MM, TOUCHING_MM
from rastrainer.scenario.scenario import Scenario, load_scenario
from rastrainer_simulator.assets import asset_path

TASK = "task-1"
HEADS = 6
PRIOR_HEADS = 500
RADIUS_MM, FREE_MM = 110.0, (30.0, 60.0)
"""The client moves on a dome about the nominal head, so far from the skin."""
STEPS = np.array([1e-3] * 3 + [1e-5] * 3)
"""Steps of the pose, mm and rad, for the numerical derivative of distances."""
WIDEST = 50.0
ROUNDS = 4


@dataclass(frozen=True)
class Readings:
    """Places of the tip, (n, 3) float, World, mm, and bounds of their distance to the skin, mm."""

    tips: np.ndarray
    low: np.ndarray
    high: np.ndarray


class PoseFit:
    """Fits the head's pose: a shift (mm) and a rotation vector (rad) about the target."""

    def __init__(self, scenario: Scenario) -> None:
        """Read the head."""
        self.scenario = scenario
        self._mesh = read_head_mesh(scenario.head)
        self.center = transforms.apply(scenario.head_to_world, scenario.target.position_ras)
        self._marks = scenario.task(TASK).fiducials

    def head_to_world(self, pose: np.ndarray) -> np.ndarray:
        """Return a pose (6,) as (4, 4) float, mm."""
        turn = Rotation.from_rotvec(pose[3:]).as_matrix()
        moved = transforms.rigid(turn, self.center + pose[:3] - turn @ self.center)
        return moved @ self.scenario.head_to_world

    def mark(self, number: int, seed: int) -> np.ndarray:
        """Return a mark of the task in the trial of a seed, (3,) float, World, mm."""
        return transforms.apply(self.scenario.perturbed_head_to_world(seed), self._marks[number])

    def distances(self, tips: np.ndarray, head_to_world: np.ndarray) -> np.ndarray:
        """Return the signed distances of points of World (n, 3) to the skin, mm."""
        points = transforms.apply(transforms.inverse(head_to_world), tips)
        found = self._mesh.tree.nearest(points)
        outward = self._mesh.triangle_normals[found.triangles]
        return np.copysign(
            found.distances, np.einsum("ij,ij->i", points - found.positions, outward)
        )

    def contacts(self, count: int, head_to_world: np.ndarray, seed: int) -> np.ndarray:
        """Return places on the skin that the tip reaches from above, (count, 3) float, World."""
        random, skin = np.random.default_rng(seed), self._mesh.vertices
        upper = skin[skin[:, 2] > np.median(skin[:, 2])]
        chosen = upper[random.choice(len(upper), count, replace=False)]
        off = random.uniform(0.0, TOUCHING_MM, (count, 1))
        return transforms.apply(head_to_world, chosen + off * outward_normals(self._mesh, chosen))

    def error_mm(self, head_to_world: np.ndarray, truth: np.ndarray) -> float:
        """Return the root mean square error of a pose at the marks, mm."""
        away = transforms.apply(head_to_world, self._marks) - transforms.apply(truth, self._marks)
        return float(np.sqrt(np.mean(np.sum(away**2, axis=1))))

    def fitted(self, readings: Readings) -> np.ndarray:
        """Return the pose that agrees best with readings, HeadToWorld, (4, 4) float, mm."""
        middle = (readings.low + readings.high) / 2.0

        def residuals(pose: np.ndarray) -> np.ndarray:
            return self.distances(readings.tips, self.head_to_world(pose)) - middle

        scales = [1.0] * 3 + [0.01] * 3
        pose = least_squares(residuals, np.zeros(6), x_scale=scales, max_nfev=60).x
        for _ in range(ROUNDS):
            pose = pose + self._to_the_middle(readings, pose)
        return self.head_to_world(pose)

    def _to_the_middle(self, readings: Readings, pose: np.ndarray) -> np.ndarray:
        """Return the step to the middle of the poses that agree, to first order."""
        here = self.distances(readings.tips, self.head_to_world(pose))
        slopes = np.array(
            [
                (self.distances(readings.tips, self.head_to_world(pose + step)) - here) / size
                for step, size in zip(np.diag(STEPS), STEPS, strict=True)
            ]
        ).T
        rows = np.vstack([slopes, -slopes])
        bounds = np.concatenate([readings.high - here, here - readings.low])
        # The smallest slack that lets the linear program succeed: distances are not quite linear.
        slackened = np.hstack([rows, -np.ones((len(rows), 1))])
        limits = [(-WIDEST, WIDEST)] * 6
        slack = linprog([0.0] * 6 + [1.0], slackened, bounds, bounds=[*limits, (0.0, None)])
        if slack.status:
            return np.zeros(6)
        bounds = bounds + slack.x[6] + 1e-9
        axes = np.vstack([np.eye(6), -np.eye(6)])
        ends = [linprog(axis, rows, bounds, bounds=limits) for axis in axes]
        found = [end.x for end in ends if not end.status]
        return np.mean(found, axis=0) if len(found) == len(ends) else slack.x[:6]


Read = Callable[[PoseFit, np.ndarray, int], Readings]


def in_the_free(count: int, width_mm: float) -> Read:
    """Read the distance `count` times in the free, rounded to a width."""

    def read(fit: PoseFit, truth: np.ndarray, seed: int) -> Readings:
        random = np.random.default_rng(seed)
        tips = _dome(fit, random, random.uniform(*FREE_MM, count))
        steps = np.round(fit.distances(tips, truth) / width_mm)
        return Readings(tips, (steps - 0.5) * width_mm, (steps + 0.5) * width_mm)

    return read


def at_the_zone(count: int, width_mm: float) -> Read:
    """Cross the border of the zone `count` times; the state changes up to a width later."""

    def read(fit: PoseFit, truth: np.ndarray, seed: int) -> Readings:
        random = np.random.default_rng(seed)
        tips = _dome(fit, random, np.full(count, NEAR_MM))
        # Move from the dome onto the border, toward the middle of the head.
        for _ in range(60):
            inward = (fit.center - tips) / np.linalg.norm(fit.center - tips, axis=1)[:, None]
            tips = tips + 0.7 * (fit.distances(tips, truth) - NEAR_MM)[:, None] * inward
        late = random.uniform(0.0, width_mm, (count, 1))
        inward = (fit.center - tips) / np.linalg.norm(fit.center - tips, axis=1)[:, None]
        return Readings(
            tips + late * inward, np.full(count, NEAR_MM - width_mm), np.full(count, NEAR_MM)
        )

    return read


def by_touch(count: int) -> Read:
    """Touch the skin `count` times: the tip stops on it."""

    def read(fit: PoseFit, truth: np.ndarray, seed: int) -> Readings:
        return Readings(
            fit.contacts(count, truth, seed), np.zeros(count), np.full(count, TOUCHING_MM)
        )

    return read


def _dome(fit: PoseFit, random: np.random.Generator, above_mm: np.ndarray) -> np.ndarray:
    around, up = (
        random.uniform(0.0, 2.0 * np.pi, len(above_mm)),
        random.uniform(0.1, 1.4, len(above_mm)),
    )
    ways = np.array([np.cos(around) * np.cos(up), np.sin(around) * np.cos(up), np.sin(up)]).T
    return fit.center + ways * (RADIUS_MM + above_mm)[:, None]


ROWS: tuple[tuple[str, Read], ...] = (
    ("17 distances to 1 µm", in_the_free(17, 1e-3)),
    ("10 distances a second, to 1 µm", in_the_free(600, 1e-3)),
    ("10 distances a second, rounded to 1 mm", in_the_free(600, 1.0)),
    ("the border of the zone, crossed 15 times at 5 mm/s", at_the_zone(15, 0.5)),
    ("the border of the zone, crossed 40 times at 15 mm/s", at_the_zone(40, 1.5)),
    ("the skin, touched 40 times", by_touch(40)),
)


def learned_mm(fit: PoseFit, read: Read, heads: int = HEADS) -> float:
    """Return the error at the marks that a client is left with, root mean square over heads."""
    found = []
    for seed in range(heads):
        truth = fit.scenario.perturbed_head_to_world(seed)
        found.append(fit.error_mm(fit.fitted(read(fit, truth, seed)), truth))
    return float(np.sqrt(np.mean(np.square(found))))


def prior_mm(fit: PoseFit) -> float:
    """Return the error at the marks of a client that has read nothing."""
    poses = map(fit.scenario.perturbed_head_to_world, range(PRIOR_HEADS))
    nominal = fit.scenario.head_to_world
    return float(np.sqrt(np.mean([fit.error_mm(nominal, pose) ** 2 for pose in poses])))


def main() -> None:
    """Print the table; each halving of the error counts as six bits, one for each freedom."""
    fit = PoseFit(load_scenario(asset_path("scenarios", "colin27")))
    nothing = prior_mm(fit)
    print("| what is read in 60 s | error at the marks | bits |\n|---|---|---|")
    print(f"| nothing | {nothing:.1f} mm | 0 |")
    for name, read in ROWS:
        error = learned_mm(fit, read)
        print(f"| {name} | {error:.2g} mm | {6.0 * math.log2(nothing / error):.0f} |", flush=True)


if __name__ == "__main__":
    main()
