"""Propose the six tasks of the default scenario; write them, `scenario.json` and README's table.

    python assets/scenarios/make_tasks.py

Takes about two minutes. The same head, robot, seed and program give the same tasks. Those that are
shipped stay as they are though the proposer has changed since: recorded trials refer to them.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from colin27_setup import CLOSE_UP_MM, PERTURBATION, head_to_world, scenario_json, write_table

from rastrainer import transforms
from rastrainer.files.point_files import write_markups
from rastrainer.files.point_list import PointList
from rastrainer.files.writing import write_json
from rastrainer.head.mesh import outward_normals, read_head_mesh
from rastrainer.head.trial_head import Perturbation, perturbed_pose
from rastrainer.scenario.points import LABELS
from rastrainer.scenario.scenario import FILE_NAME
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.authoring.planning_setup import touchable
from rastrainer_simulator.authoring.task_proposal import (
    PLANS,
    Proposal,
    TaskProposer,
    places_seen_from,
    target_spread,
)
from rastrainer_simulator.authoring.task_set import smooth_places
from rastrainer_simulator.authoring.touch_order import SurfaceGraph, shortest_path_mm
from rastrainer_simulator.collision.collision import Collision
from rastrainer_simulator.collision.robot_shape import robot_shape
from rastrainer_simulator.collision.touch_planner import TouchPlanner
from rastrainer_simulator.robot.model import load_robot

FOLDER = Path(__file__).parent / "colin27"

SEED = 27
PLACE_SPACING_MM = 10.0
POSES_TRIED, POSES_CHECKED = 80, 50

WIDER = Perturbation(
    1.3 * PERTURBATION.translation_mm, 1.3 * PERTURBATION.yaw_deg, 1.3 * PERTURBATION.tilt_deg
)
"""The places are tried in poses perturbed by more than a trial's: a margin."""


class Workbench:
    """The head on its stand before the robot."""

    def __init__(self) -> None:
        self.mesh = read_head_mesh(FOLDER / "head.ply")
        self.graph = SurfaceGraph(self.mesh)
        self.center = self.mesh.centroid.round(4)
        self.head_to_world = head_to_world(self.center)
        self.eye = transforms.apply(transforms.inverse(self.head_to_world), CLOSE_UP_MM)
        robot = load_robot()
        self._collision = Collision(
            robot_shape(robot), self.mesh.vertices / MM_PER_M, self.mesh.triangles
        )
        self._planner = TouchPlanner(robot, self._collision)

    def touchable(
        self, positions: np.ndarray, normals: np.ndarray, limits: Perturbation, seeds: range
    ) -> np.ndarray:
        """Return which places can be touched in the nominal and in all seeded poses."""
        poses = [self.head_to_world]
        poses += [perturbed_pose(self.head_to_world, self.center, limits, seed) for seed in seeds]
        return touchable(self._planner, self._collision, positions, normals, poses)


def main() -> int:
    """Write the scenario's files; the exit status is 1 where a fiducial cannot be touched."""
    bench = Workbench()
    vertices = smooth_places(bench.mesh, PLACE_SPACING_MM)
    positions = bench.mesh.vertices[vertices].round(4)
    normals = bench.mesh.vertex_normals[vertices]
    can_be = bench.touchable(positions, normals, WIDER, range(1000, 1000 + POSES_TRIED))
    print(f"{can_be.sum()} of {len(can_be)} smooth places can be touched in every pose.")
    places = places_seen_from(bench.mesh, positions[can_be], normals[can_be], bench.eye)
    proposer = TaskProposer(bench.mesh, places, bench.eye, bench.center)
    proposals = proposer.propose_rising(PLANS, SEED)
    for proposal in proposals:
        write_markups(FOLDER / _file(proposal), PointList(LABELS, proposal.fiducials))
    content = scenario_json(bench.center, [entry(proposal, bench) for proposal in proposals])
    write_json(FOLDER / FILE_NAME, content)
    write_table(Path(__file__).name, table_of(proposals, bench.center))
    return 0 if all(is_touchable(bench, proposal) for proposal in proposals) else 1


def is_touchable(bench: Workbench, proposal: Proposal) -> bool:
    """Tell whether all fiducials of a task can be touched in the poses of many trials."""
    normals = outward_normals(bench.mesh, proposal.fiducials)
    can_be = bench.touchable(proposal.fiducials, normals, PERTURBATION, range(POSES_CHECKED))
    missed = [label for label, can in zip(LABELS, can_be, strict=True) if not can]
    print(f"{proposal.plan.title}: {'not ' + ', '.join(missed) if missed else 'all'} touchable.")
    return not missed


def entry(proposal: Proposal, bench: Workbench) -> dict[str, Any]:
    """Return a task's entry in `scenario.json`; the parts of the complexity are for readers."""
    parts = proposal.complexity
    return {
        "name": proposal.plan.name,
        "title": proposal.plan.title,
        "file": _file(proposal),
        "complexity": round(parts.index, 2),
        "shortestPathMm": round(shortest_path_mm(proposal.fiducials, bench.mesh, bench.graph), 1),
        "complexityParts": {
            "pathLengthMm": round(parts.path_length_mm),
            "turningDeg": round(parts.turning_deg),
            "hiddenPoints": parts.hidden_points,
            "reorientationDeg": round(parts.reorientation_deg),
        },
    }


def table_of(proposals: list[Proposal], center: np.ndarray) -> str:
    """Return the numbers of the tasks as a table in Markdown."""
    rows = [
        "| task | path, mm | turning, ° | hidden fiducials | reorientation, ° | complexity index | "
        "expected TRE / FLE |",
        "|---|---|---|---|---|---|---|",
    ]
    for proposal in proposals:
        parts, ratio = proposal.complexity, target_spread(proposal.fiducials, center) ** 0.5
        rows.append(
            f"| {proposal.plan.title} | {parts.path_length_mm:.0f} | {parts.turning_deg:.0f} | "
            f"{parts.hidden_points} | {parts.reorientation_deg:.0f} | {parts.index:.2f} | "
            f"{ratio:.2f} |"
        )
    return "\n".join(rows) + "\n"


def _file(proposal: Proposal) -> str:
    return f"tasks/{proposal.plan.name}.mrk.json"


if __name__ == "__main__":
    sys.exit(main())
