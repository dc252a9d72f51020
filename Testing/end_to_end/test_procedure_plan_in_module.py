"""A procedure is planned in Slicer by lines, checked by the simulator's program, and saved."""

from __future__ import annotations

import numpy as np

from rastrainer.procedure.plan import read_procedure_meshes
from rastrainer.scenario.library import user_library
from rastrainer.scenario.scenario import load_scenario
from rastrainer.slicer.scene.nodes import setPoints, worldPoints
from rastrainer.slicer.scene.procedure_lines import instrumentOf, noGoNodes, planLines
from Testing.end_to_end.module.story import Story
from Testing.slicer.host.fixtures import *  # noqa: F403 (the fixture `host`)

DBS = "Deep brain stimulation of both subthalamic nuclei"


def cells(host):
    table = host.find("linesTable")
    return [
        [table.item(row, column).text() for column in range(table.columnCount)]
        for row in range(table.rowCount)
    ]


def test_a_procedure_is_edited_checked_and_saved_in_a_copy_of_its_scenario(host, tmp_path):
    Story(host, tmp_path).choose_own_program()
    host.choose("scenarioComboBox", 0)
    host.choose("procedurePlanComboBox", DBS)
    host.press("editProcedureButton")
    assert cells(host) == [
        ["Left subthalamic nucleus", "96.1", "–", "–", "–", "–"],
        ["Right subthalamic nucleus", "94.7", "–", "–", "–", "–"],
    ]
    host.press("checkLinesButton")
    left = cells(host)[0]
    assert left[2] == "18.2"
    assert left[3].startswith("2.9 Left lateral ventricle")
    assert left[4] == "23.9 Right subthalamic nucleus"
    assert left[5] == "yes"
    assert host.text("procedurePlanText") == "The procedure can be carried out."

    right = worldPoints(planLines(host.scene)[1]).copy()
    right[1, 2] += 1.0
    setPoints(planLines(host.scene)[1], ("Entry", "Target"), right)
    host.wait_until(
        lambda: "check it again" in host.text("procedurePlanText"), "the message is shown"
    )
    assert cells(host)[0][2] == "–"
    host.choose("linesTable", 1)
    host.type("lineNameLineEdit", "Right STN")
    host.type("lineDiameterSpinBox", "2.0")
    host.type("procedureScenarioLineEdit", "My DBS")
    host.press("saveProcedureButton")
    assert host.messages == []
    saved = load_scenario(user_library() / "my-dbs")
    assert [each.name for each in saved.procedures] == ["biopsy", "dbs", "seeg"]
    dbs = saved.procedure("dbs")
    assert [each.name for each in dbs.trajectories] == ["Left subthalamic nucleus", "Right STN"]
    assert dbs.trajectories[1].diameter_mm == 2.0
    np.testing.assert_allclose(dbs.trajectories[1].target_ras, right[1], atol=1e-3)
    assert len(dbs.checkpoints) == 6
    meshes = read_procedure_meshes(dbs, saved.skull.file).no_go
    assert list(meshes) == [node.GetName() for node in noGoNodes(host.scene)]
    assert host.find("scenarioComboBox").currentText == "My DBS"
    assert host.find("procedureComboBox").count == 4


def place_line(host, count):
    """Place a line by two clicks; it is the last of so many."""
    host.press("placeLineButton")
    host.place(0.0, -20.0, 100.0)
    host.place(2.0, -15.0, 5.0)
    host.wait_until(lambda: [row[1] for row in cells(host)] == ["95.2"] * count, "its length")


def names(host):
    return [row[0] for row in cells(host)]


def test_buttons_place_reorder_remove_and_restore_lines_and_mark_what_to_keep_away_from(host):
    host.open()
    host.choose("procedureKindComboBox", "Stereo-EEG")
    for count, name in enumerate(("First", "Second"), start=1):
        place_line(host, count)
        host.choose("linesTable", count - 1)
        host.type("lineNameLineEdit", name)
    assert host.find("checkLinesButton").enabled
    host.press("raiseLineButton")
    assert names(host) == ["Second", "First"]
    assert [line.GetName() for line in planLines(host.scene)] == ["Second", "First"]
    assert host.text("lineNameLineEdit") == "Second"
    assert not host.find("raiseLineButton").enabled
    host.type("lineDiameterSpinBox", "2.0")
    kept = cells(host)[0], worldPoints(planLines(host.scene)[0]).tolist()
    for _line in range(2):
        host.choose("linesTable", 0)
        host.press("removeLineButton")
    assert cells(host) == planLines(host.scene) == []
    assert not host.find("saveProcedureButton").enabled
    for _line in range(2):
        host.press("restoreLineButton")
    first, second = planLines(host.scene)
    assert names(host) == ["Second", "First"]
    assert (cells(host)[0], worldPoints(first).tolist()) == kept
    assert instrumentOf(first)[0] == 2.0 != instrumentOf(second)[0]
    assert not host.find("restoreLineButton").enabled
    model = host.scene.AddNewNodeByClass("vtkMRMLModelNode", "Vein")
    host.choose("noGoComboBox", model)
    for text, following in (("Vein", "Ignore"), ("–", "Keep away")):
        host.press("noGoButton")
        assert host.text("noGoText") == f"To keep away from: {text}"
        assert host.text("noGoButton") == following
    host.press("placeCheckpointButton")
    host.place(0.0, 80.0, 40.0)
    checkpoints = host.find("checkpointsComboBox").currentNode()
    assert worldPoints(checkpoints).round(6).tolist() == [[0.0, 80.0, 40.0]]
