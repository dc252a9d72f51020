"""The plan of a procedure: taken from a scenario, read from the scene, checked and saved."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import vtk

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.files.writing import write_json
from rastrainer.head.mesh import HeadMesh, write_head_mesh
from rastrainer.json_checks import identifier_of
from rastrainer.json_records import record_from_json
from rastrainer.procedure.checks import MeasuredProcedure
from rastrainer.procedure.plan import (
    MAX_NO_GO,
    MAX_TRAJECTORIES,
    MIN_LENGTH_MM,
    NO_GO_FOLDER,
    Checkpoint,
    NoGoStructure,
    Procedure,
    ProcedureKind,
    ProcedureTrajectory,
    check_no_go_mesh,
    check_no_go_size,
    procedure_json,
    read_procedure_meshes,
)
from rastrainer.scenario.scenario import Scenario
from rastrainer.sections.scenario_files import ScenarioFiles
from rastrainer.slicer.scene.nodes import labelsOf, setValues, worldPoints
from rastrainer.slicer.scene.plan_points import ENDS, placedPoints
from rastrainer.slicer.scene.procedure_lines import instrumentOf, noGoNodes, planLines, showPlan
from rastrainer.slicer.translation import _
from rastrainer.work_progress import Progress

Plan = tuple[Procedure, dict[str, HeadMesh]]
"""A procedure, and the meshes of its no-go structures by file name."""


def editPlan(scene: Any, scenario: Scenario, name: str) -> Procedure | None:
    """Show a procedure in the scene, to be changed; an empty one without a name."""
    procedure = scenario.procedure(name) if name else None
    meshes = procedure and read_procedure_meshes(procedure, scenario.skull_path)
    showPlan(scene, procedure, meshes.no_go if meshes else {})
    return procedure


def readPlan(
    scene: Any, title: str, kind: str, source: str = "", name: str = "", checkpoints: Any = None
) -> Plan:
    """Return the plan of the scene.

    `name` is empty for a new procedure, whose name its title gives; without a `source`, the
    coordinates were placed in Slicer. `checkpoints` is a list of points on the skin, or None.
    """
    title = title.strip()
    if not title:
        raise InputError(_("Enter a title for the procedure."))
    trajectories = _trajectories(scene)
    noGo = noGoMeshes(noGoNodes(scene))
    files = [f"structure-{number}.ply" for number in range(1, len(noGo) + 1)]
    if len(files) > MAX_NO_GO:
        text = _("The plan has {count} no-go structures; it may have {most}.")
        raise InputError(text.format(count=len(files), most=MAX_NO_GO))
    name = name or identifier_of(title)
    if not name:
        text = _("{title} cannot be a procedure's title: it needs a Latin letter or digit.")
        raise InputError(text.format(title=title))
    places = () if checkpoints is None else worldPoints(checkpoints)
    labels = () if checkpoints is None else labelsOf(checkpoints)
    structures = zip(noGo, files, strict=True)
    procedure = Procedure(
        name,
        title[:80],
        ProcedureKind(kind),
        source.strip() or _("Planned in 3D Slicer."),
        trajectories,
        tuple(NoGoStructure(each[:60], Path(NO_GO_FOLDER, file)) for each, file in structures),
        tuple(map(Checkpoint, labels, places)),
    )
    return procedure, dict(zip(files, noGo.values(), strict=True))


def checkPlan(
    files: ScenarioFiles, scenario: Scenario, plan: Plan, progress: Progress
) -> MeasuredProcedure:
    """Measure the plan on the head of a scenario; nothing is changed."""
    with planFile(*plan) as path:
        measures = path.with_name("lines.json")
        words = ["lines", str(scenario.folder), "--procedure", str(path)]
        words += ["--json", str(measures)]
        refusal = files.run(words, progress, mayFail=True)
        if not measures.is_file():
            raise InputError(refusal)
        (measured,) = json.loads(measures.read_text(encoding="utf-8"))
    return record_from_json(MeasuredProcedure, measured)


def _trajectories(scene: Any) -> tuple[ProcedureTrajectory, ...]:
    lines = planLines(scene)
    if not 1 <= len(lines) <= MAX_TRAJECTORIES:
        text = _("A procedure has 1 to {most} lines; the plan has {count}. Place a line.")
        raise InputError(text.format(most=MAX_TRAJECTORIES, count=len(lines)))
    names = [line.GetName() for line in lines]
    for name in names:
        if names.count(name) > 1:
            text = _("Two lines are named {name}: give each its own name.")
            raise InputError(text.format(name=name))
    return tuple(_trajectory(line) for line in lines)


@contextmanager
def planFile(procedure: Procedure, meshes: dict[str, HeadMesh]) -> Iterator[Path]:
    """Yield a file of the plan, next to the meshes of its no-go structures."""
    with tempfile.TemporaryDirectory() as temporary:
        path = Path(temporary, "procedure.json")
        (path.parent / NO_GO_FOLDER).mkdir()
        for name, mesh in meshes.items():
            write_head_mesh(path.parent / NO_GO_FOLDER / name, mesh)
        write_json(path, procedure_json(procedure))
        yield path


def _trajectory(line: Any) -> ProcedureTrajectory:
    name = line.GetName()
    if len(placedPoints(line)) != ENDS:
        text = _("{name} needs two points: its entry and its target.")
        raise InputError(text.format(name=name))
    entry, target = (np.array(point) for point in worldPoints(line))
    trajectory = ProcedureTrajectory(name[:60], entry, target, *instrumentOf(line))
    if trajectory.length_mm < MIN_LENGTH_MM:
        text = _("{name} is {length:.1f} mm long; it must be at least {least:g} mm.")
        raise InputError(text.format(name=name, length=trajectory.length_mm, least=MIN_LENGTH_MM))
    return trajectory


def noGoMeshes(nodes: list[Any]) -> dict[str, HeadMesh]:
    """Return the surfaces of models, and of each segment of segmentations, by name, RAS mm."""
    found: dict[str, HeadMesh] = {}
    for node in nodes:
        for name, surface in _surfaces(node):
            if name in found:
                text = _("Two no-go structures are named {name}: give each its own name.")
                raise InputError(text.format(name=name))
            found[name] = _mesh(name, surface, node)
    return found


def _surfaces(node: Any) -> Iterator[tuple[str, vtk.vtkPolyData]]:
    if node.IsA("vtkMRMLModelNode"):
        yield node.GetName(), node.GetPolyData()
        return
    segmentation = node.GetSegmentation()
    node.CreateClosedSurfaceRepresentation()
    for segmentId in segmentation.GetSegmentIDs():
        surface = vtk.vtkPolyData()
        node.GetClosedSurfaceRepresentation(segmentId, surface)
        yield segmentation.GetSegment(segmentId).GetName(), surface


def _mesh(name: str, surface: vtk.vtkPolyData | None, node: Any) -> HeadMesh:
    from rastrainer.slicer.head.surface import meshOf
    from rastrainer.slicer.head.volume import toWorld

    if surface is None or surface.GetNumberOfPolys() == 0:
        raise InputError(_("The no-go structure {name} is empty.").format(name=name))
    # Before anything takes long.
    check_no_go_size(surface.GetNumberOfPolys(), name)
    triangles = vtk.vtkTriangleFilter()
    setValues(triangles, InputData=surface, PassLines=False, PassVerts=False)
    merged = vtk.vtkCleanPolyData()
    setValues(merged, InputConnection=triangles.GetOutputPort()).Update()
    mesh = meshOf(merged.GetOutput())
    placed = HeadMesh(transforms.apply(toWorld(node), mesh.vertices), mesh.triangles)
    check_no_go_mesh(placed, name)
    return placed
