"""Plan the three procedures of the default scenario; write them, and README's table.

    python assets/scenarios/make_procedures.py

Takes about a minute. The same head, skull, robot and program give the same plan. The targets are
numbers from publications; nothing else of them is in the repository. The no-go structures are
schematic tubes along a course that is written down here: they are no vessels of this person.
"""

import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import trimesh

from rastrainer.files.reading import read_json
from rastrainer.files.writing import write_json, write_text
from rastrainer.head.mesh import HeadMesh, mesh_crossings, read_head_mesh, write_head_mesh
from rastrainer.procedure.checks import measure_lines, planned_bone
from rastrainer.procedure.geometry import axis_distance_mm, segment_distances_mm, skull_angle_deg
from rastrainer.procedure.plan import (
    Checkpoint,
    NoGoStructure,
    Procedure,
    ProcedureKind,
    ProcedureTrajectory,
    procedure_json,
    read_procedure_meshes,
)
from rastrainer.scenario.scenario import FILE_NAME, load_scenario
from rastrainer_simulator.authoring.planning_setup import WIDER, PlanningSetup
from rastrainer_simulator.authoring.procedure_plan import is_guide_held
from rastrainer_simulator.authoring.task_set import smooth_places

FOLDER = Path(__file__).parent / "colin27"
Point = tuple[float, float, float]
WantedTrajectory = tuple[str, Point, Point]
"""Name, target (R, A, S in mm), and the direction from it to the entry that is preferred."""

HEAD_SPACE = (
    "The MRI is in the space of the MNI (stereotaxic, not warped), so the coordinates are only as "
    "right for this person as such a space allows: they are for training, not anatomy."
)
AAL = (
    "Targets: centroids of regions of the atlas AAL (Tzourio-Mazoyer et al. 2002, "
    "doi:10.1006/nimg.2001.0978), which was drawn on this very MRI."
)
STN = (
    "Targets: mean position of the active contacts in deep brain stimulation of the subthalamic "
    "nucleus for Parkinson's disease, (±12.58, −13.41, −5.87) mm in MNI space: Caire et al. 2013, "
    "doi:10.1007/s00701-013-1782-1, converted from AC-PC coordinates by Horn et al. 2017, "
    "doi:10.1016/j.neuroimage.2017.02.004."
)
SCHEMATIC = (
    "The no-go structures are schematic tubes along a stated course (make_procedures.py), no "
    "vessels or ventricles of this person. Entries: proposed so that the drill meets the skull "
    "steeply and the robot reaches along the line."
)


@dataclass(frozen=True)
class Tube:
    """A schematic structure: a course through points (R, A, S) and a radius, mm."""

    name: str
    radius: float
    course: tuple[Point, ...]


VENTRICLE = ((9, 30, 0), (12, 20, 12), (12, 5, 20), (14, -12, 23), (18, -30, 21), (24, -42, 12))
TUBES = {
    "right-ventricle": Tube("Right lateral ventricle (schematic)", 4.0, VENTRICLE),
    "left-ventricle": Tube(
        "Left lateral ventricle (schematic)", 4.0, tuple((-r, a, s) for r, a, s in VENTRICLE)
    ),
    "right-mca": Tube(
        "Right middle cerebral artery (schematic)",
        1.5,
        ((9, 1, -14), (22, 3, -17), (35, 4, -15), (44, 8, -5), (46, 5, 6), (47, -8, 14)),
    ),
    "right-pca": Tube(
        "Right posterior cerebral artery (schematic)",
        1.3,
        ((3, -20, -12), (13, -23, -9), (18, -34, -5), (15, -48, 0), (11, -62, 3)),
    ),
}
SINUS, SINUS_RADIUS = "sagittal-sinus", 4.0
"""Its course follows the inner table in the midline."""

DIRECTIONS = {
    "Right forehead": (0.45, 1.0, 0.55),
    "Left forehead": (-0.45, 1.0, 0.55),
    "Vertex": (0.0, -0.1, 1.0),
    "Right parietal": (0.8, -0.45, 0.7),
    "Left parietal": (-0.8, -0.45, 0.7),
    "Occiput": (0.0, -1.0, 0.25),
}
"""Checkpoints are sought in these directions from the head's center."""

CANDIDATES = 4000
STEEPEST_COST, AWAY_COST, LENGTH_COST = 1.0, 1.0, 0.15
POSES = 12
REACH_MM = 300.0
APART_MM = 3.0


class Planner:
    """Finds entries on the head of the scenario."""

    def __init__(self) -> None:
        self.scenario = load_scenario(FOLDER)
        self.head = read_head_mesh(self.scenario.head)
        self.skull = read_head_mesh(FOLDER / "skull.ply")
        self.planning = PlanningSetup(self.scenario, self.head)
        self.poses = self.planning.poses(range(POSES), WIDER)

    def trajectories(
        self,
        wanted: tuple[WantedTrajectory, ...],
        no_go: list[HeadMesh],
        diameter_mm: float,
        safety_mm: float,
    ) -> tuple[ProcedureTrajectory, ...]:
        """Return the trajectories with the best entries that are free and within reach."""
        found: list[ProcedureTrajectory] = []
        for one in wanted:
            for trajectory in self._by_cost(*one, diameter_mm, safety_mm):
                if self._is_free(trajectory, no_go, found) and is_guide_held(
                    self.planning, trajectory, self.poses
                ):
                    found.append(trajectory)
                    break
            else:
                raise SystemExit(f"{one[0]}: no entry was found.")
        return tuple(found)

    def _by_cost(
        self, name: str, target: Point, toward: Point, diameter_mm: float, safety_mm: float
    ) -> Iterator[ProcedureTrajectory]:
        """Yield trajectories: steep to the skull, near the preferred direction, and short."""
        target, toward = np.array(target), np.array(toward) / np.linalg.norm(toward)
        out = np.random.default_rng(27).normal(size=(CANDIDATES, 3))
        out /= np.linalg.norm(out, axis=1)[:, None]
        costs = []
        for direction in out[out @ toward > np.cos(np.radians(25.0))]:
            crossings = mesh_crossings(self.head, target, direction, REACH_MM)
            if len(crossings) != 1:
                continue
            entry = (target + crossings[0].distance_mm * direction).round(2)
            one = ProcedureTrajectory(name, entry, target, diameter_mm, safety_mm)
            bone = planned_bone(one, self.skull)
            if bone is None or bone.inner_mm is None:
                continue
            away_deg = np.degrees(np.arccos(np.clip(direction @ toward, -1.0, 1.0)))
            cost = (
                STEEPEST_COST
                * skull_angle_deg(self.skull, entry + bone.outer_mm * one.direction, one.direction)
                + AWAY_COST * away_deg
                + LENGTH_COST * crossings[0].distance_mm
            )
            costs.append((float(cost), tuple(entry.tolist())))
        for _cost, entry in sorted(costs):
            yield ProcedureTrajectory(name, np.array(entry), target, diameter_mm, safety_mm)

    def _is_free(
        self,
        trajectory: ProcedureTrajectory,
        no_go: list[HeadMesh],
        others: list[ProcedureTrajectory],
    ) -> bool:
        radius = trajectory.diameter_mm / 2
        entry, target = trajectory.entry_ras, trajectory.target_ras
        is_clear = all(
            axis_distance_mm(mesh, entry, target) - radius > trajectory.safety_mm + 0.5
            for mesh in no_go
        )
        return is_clear and all(
            segment_distances_mm(entry, target, other.entry_ras[None], other.target_ras[None])[0]
            > 2 * radius + APART_MM
            for other in others
        )

    def checkpoints(self) -> tuple[Checkpoint, ...]:
        """Return places of smooth skin that the robot can touch in every pose of the head."""
        vertices = smooth_places(self.head, 8.0)
        places, normals = self.head.vertices[vertices], self.head.vertex_normals[vertices]
        can_be = self.planning.touchable(places, normals, self.poses)
        places = places[can_be]
        out = places - self.scenario.target.position_ras
        out /= np.linalg.norm(out, axis=1)[:, None]
        found = []
        for name, direction in DIRECTIONS.items():
            best = (out @ (np.array(direction) / np.linalg.norm(direction))).argmax()
            found.append(Checkpoint(name, places[best].round(4)))
        return tuple(found)

    def sinus(self) -> Tube:
        """Return the superior sagittal sinus: along the inner table in the midline."""
        center = np.array([0.0, -17.0, 20.0])
        course = []
        for degrees in np.arange(35.0, 196.0, 10.0):
            out = np.array([0.0, np.cos(np.radians(degrees)), np.sin(np.radians(degrees))])
            inner = mesh_crossings(self.skull, center, out, REACH_MM)[0].distance_mm
            course.append(tuple((center + (inner - SINUS_RADIUS) * out).round(2).tolist()))
        return Tube("Superior sagittal sinus (schematic)", SINUS_RADIUS, tuple(course))


def tube_mesh(tube: Tube) -> HeadMesh:
    """Return the closed surface of a tube: cylinders between balls, joined."""
    parts = []
    for start, end in pairwise(tube.course):
        parts.append(trimesh.creation.cylinder(tube.radius, segment=(start, end), sections=16))
    for point in tube.course:
        ball = trimesh.creation.icosphere(2, tube.radius)
        parts.append(ball.apply_translation(point))
    joined = trimesh.boolean.union(parts, engine="manifold")
    return HeadMesh(np.array(joined.vertices), np.array(joined.faces, dtype=np.int32))


def planned(planner: Planner) -> tuple[list[Procedure], dict[str, HeadMesh]]:
    """Return the three procedures, and the meshes of their no-go structures by file name."""
    tubes = {**TUBES, SINUS: planner.sinus()}
    meshes = {name: tube_mesh(tube) for name, tube in tubes.items()}
    checkpoints = planner.checkpoints()
    procedures = []
    for name, title, kind, source, wanted, structures, diameter, safety in PLANS:
        named = tuple(
            NoGoStructure(tubes[each].name, FOLDER / "no-go" / f"{each}.ply") for each in structures
        )
        obstacles = [meshes[each] for each in structures]
        trajectories = planner.trajectories(wanted, obstacles, diameter, safety)
        text = f"{source} {SCHEMATIC} {HEAD_SPACE}"
        procedures.append(Procedure(name, title, kind, text, trajectories, named, checkpoints))
    return procedures, {f"{name}.ply": mesh for name, mesh in meshes.items()}


PLANS = (
    (
        "biopsy",
        "Biopsy of a frontal lesion",
        ProcedureKind.BIOPSY,
        "Target: the center of a made-up lesion in the right frontal white matter.",
        (("Right frontal lesion", (28.0, 30.0, 24.0), (0.4, 0.35, 0.8)),),
        (SINUS, "right-ventricle"),
        2.1,
        3.0,
    ),
    (
        "dbs",
        "Deep brain stimulation of both subthalamic nuclei",
        ProcedureKind.DBS,
        STN,
        (
            ("Left subthalamic nucleus", (-12.58, -13.41, -5.87), (-0.3, 0.5, 0.85)),
            ("Right subthalamic nucleus", (12.58, -13.41, -5.87), (0.3, 0.5, 0.85)),
        ),
        (SINUS, "left-ventricle", "right-ventricle"),
        1.27,
        2.0,
    ),
    (
        "seeg",
        "Stereo-EEG of the right hemisphere",
        ProcedureKind.SEEG,
        AAL,
        (
            ("Right hippocampus", (28.23, -19.78, -10.33), (0.35, -0.85, 0.35)),
            ("Right insula", (38.02, 6.25, 2.08), (0.15, 0.6, 0.8)),
            ("Right anterior cingulate", (7.46, 37.01, 15.84), (0.6, 0.5, 0.6)),
            ("Right middle cingulate", (7.02, -8.83, 39.79), (0.6, 0.2, 0.8)),
            ("Right posterior cingulate", (6.44, -41.81, 21.87), (0.5, -0.6, 0.6)),
        ),
        (SINUS, "right-mca", "right-pca"),
        0.8,
        3.0,
    ),
)


def main() -> int:
    planner = Planner()
    procedures, meshes = planned(planner)
    (FOLDER / "no-go").mkdir(exist_ok=True)
    for name, mesh in meshes.items():
        write_head_mesh(FOLDER / "no-go" / name, mesh)
    content = read_json(FOLDER / FILE_NAME, 2**20)
    content["skull"] = {"file": "skull.ply", "kind": "approximation"}
    content["procedures"] = [procedure_json(procedure) for procedure in procedures]
    write_json(FOLDER / FILE_NAME, content)
    readme, start = FOLDER.with_name("README.md"), "<!-- table by make_procedures.py -->\n"
    before, _, rest = readme.read_text(encoding="utf-8").partition(start)
    after = rest[rest.index("<!-- end of table -->") :]
    write_text(readme, before + start + table_of(procedures) + after)
    return 0


def table_of(procedures: list[Procedure]) -> str:
    """Return the numbers of the trajectories as a table in Markdown."""
    rows = [
        "| procedure | trajectory | target, R A S mm | length, mm | angle to the skull, ° | "
        "nearest no-go structure, mm |",
        "|---|---|---|---|---|---|",
    ]
    for procedure in procedures:
        meshes = read_procedure_meshes(procedure, FOLDER / "skull.ply")
        lines = measure_lines(procedure, meshes)
        for trajectory, line in zip(procedure.trajectories, lines, strict=True):
            target = ", ".join(f"{value:g}" for value in trajectory.target_ras)
            nearest = line.nearest_no_go
            rows.append(
                f"| {procedure.title} | {line.name} | {target} | {line.length_mm:.0f} | "
                f"{line.skull_angle_deg:.0f} | {line.no_go_mm[nearest]:.1f}, {nearest} |"
            )
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    sys.exit(main())
