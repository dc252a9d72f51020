"""The plan of a procedure in the scene: read, with one message for a missing part, and stored."""

import numpy as np
import pytest
import vtk

from rastrainer.errors import InputError
from rastrainer.procedure.plan import MAX_NO_GO_TRIANGLES
from rastrainer.sections.procedure_plan_logic import noGoMeshes, readPlan
from rastrainer.slicer.scene.nodes import Role, setPoints, setValues
from rastrainer.slicer.scene.plan_points import unfinishedLine
from rastrainer.slicer.scene.procedure_lines import (
    instrumentOf,
    isNoGo,
    noGoNodes,
    planLines,
    setInstrument,
    setNoGo,
    showPlan,
)
from Testing.domain.procedure.made_up_procedure import made_up_procedure, vessel
from Testing.slicer.scene_bundle import load_bundle

PLAN = {"title": "Two leads", "kind": "dbs"}
ENDS = np.array([[0.0, 0.0, 90.0], [0.0, 0.0, 20.0]])


def placed(scene, name="Line", ends=ENDS):
    line = unfinishedLine(scene, Role.PLAN_LINE)
    line.SetName(name)
    setPoints(line, ("Entry", "Target"), ends)
    return line


def sphere_node(scene, name="Vessel", resolution=20, is_open=False):
    source = setValues(vtk.vtkSphereSource(), Radius=5.0, EndTheta=300.0 if is_open else 360.0)
    setValues(source, ThetaResolution=resolution, PhiResolution=resolution).Update()
    node = scene.AddNewNodeByClass("vtkMRMLModelNode", name)
    node.SetAndObservePolyData(source.GetOutput())
    setNoGo(node, True)
    return node


def open_sphere(line):
    sphere_node(line.GetScene(), is_open=True)


def test_a_displayed_plan_is_read_back_unchanged(scene):
    procedure = made_up_procedure()
    showPlan(scene, procedure, {"Vessel": vessel()})
    node = scene.GetFirstNodeByName("Checkpoints")
    read, meshes = readPlan(scene, **PLAN, name="dbs-1", checkpoints=node)
    assert [each.name for each in read.trajectories] == ["Left", "Right"]
    for one, other in zip(read.trajectories, procedure.trajectories, strict=True):
        np.testing.assert_allclose(one.entry_ras, other.entry_ras)
        assert (one.diameter_mm, one.safety_mm) == (other.diameter_mm, other.safety_mm)
    assert (read.name, read.title, read.kind.value) == ("dbs-1", "Two leads", "dbs")
    assert [(each.name, each.file.name) for each in read.no_go] == [("Vessel", "structure-1.ply")]
    assert meshes["structure-1.ply"].is_closed
    assert read.checkpoints[0].name == "Vertex"


@pytest.mark.parametrize(
    ("sentence", "spoil"),
    [
        ("Line needs two points: its entry", lambda line: line.RemoveNthControlPoint(1)),
        ("A procedure has 1 to 20 lines", lambda line: line.GetScene().RemoveNode(line)),
        ("Two lines are named Line", lambda line: placed(line.GetScene())),
        (
            "Line is 4.0 mm long; it must be at least 10 mm.",
            lambda line: setPoints(line, ("", ""), np.array([[0.0, 0, 5], [0, 0, 1]])),
        ),
        ("The no-go structure Vessel is not closed: it has a hole.", open_sphere),
        (
            f"it may have {MAX_NO_GO_TRIANGLES}.",
            lambda line: sphere_node(line.GetScene(), resolution=400),
        ),
    ],
)
def test_anything_missing_or_unusable_is_reported_in_one_sentence(scene, sentence, spoil):
    spoil(placed(scene))
    with pytest.raises(InputError) as refused:
        readPlan(scene, **PLAN)
    assert sentence in str(refused.value)


def test_a_plan_needs_a_title_from_which_a_name_can_be_made(scene):
    placed(scene)
    with pytest.raises(InputError, match="needs a Latin letter or digit"):
        readPlan(scene, "Ω", "dbs")
    assert readPlan(scene, "Ä first: Try!", "dbs")[0].name == "first-try"


def test_a_model_where_its_transform_places_it_and_each_segment_is_a_structure(scene):
    model = sphere_node(scene)
    transform = scene.AddNewNodeByClass("vtkMRMLLinearTransformNode")
    matrix = vtk.vtkMatrix4x4()
    matrix.SetElement(0, 3, 25.0)
    transform.SetMatrixTransformToParent(matrix)
    model.SetAndObserveTransformNodeID(transform.GetID())
    node = scene.AddNewNodeByClass("vtkMRMLSegmentationNode", "Vessels")
    node.GetSegmentation().SetSourceRepresentationName("Closed surface")
    for name, x in (("Artery", -20.0), ("Vein", 20.0)):
        source = setValues(vtk.vtkSphereSource(), Center=(x, 0.0, 0.0), Radius=6.0)
        source.Update()
        node.AddSegmentFromClosedSurfaceRepresentation(source.GetOutput(), name, [1.0, 0.0, 0.0])
    meshes = noGoMeshes([node, model])
    assert list(meshes) == ["Artery", "Vein", "Vessel"]
    assert meshes["Vessel"].vertices[:, 0].mean() == pytest.approx(25.0, abs=0.1)
    assert meshes["Vein"].vertices[:, 0].mean() == pytest.approx(20.0, abs=0.5)


def test_instruments_and_structures_are_kept_with_the_scene(headless_scene, scene, tmp_path):
    line = placed(headless_scene.scene, "Left")
    setInstrument(line, 2.25, 3.5)
    sphere_node(headless_scene.scene)
    headless_scene.save(tmp_path / "plan.mrb")
    load_bundle(headless_scene, tmp_path / "plan.mrb")
    (line,) = planLines(headless_scene.scene)
    assert instrumentOf(line) == (2.25, 3.5)
    (node,) = noGoNodes(headless_scene.scene)
    assert isNoGo(node)
    procedure, meshes = readPlan(scene, **PLAN)
    assert procedure.trajectories[0].diameter_mm == 2.25
    assert len(meshes) == 1
    # Another plan removes its models and unmarks the user's.
    showPlan(scene, None, {"Shown": vessel()})
    assert [each.GetName() for each in noGoNodes(scene)] == ["Shown"]
    showPlan(scene, None, {})
    assert noGoNodes(scene) == []
    assert scene.GetFirstNodeByName("Shown") is None
    assert node.GetScene() is scene
