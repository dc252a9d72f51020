"""Every panel in the host: actions and refusals of its buttons, and the messages."""

import csv
import json
import sqlite3
import sys
import uuid
from pathlib import Path

import numpy as np
import pytest
from PySide6 import QtCore

from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.slicer.scene.nodes import Role, setPoints
from rastrainer.study.database.study import Study
from rastrainer.study.protocol.study_progress import StudyProgress
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.widgets.plain_text import toolTip
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.cli.main import main
from Testing.slicer.recorded_trial import (
    put_touches,
    store_trial_on_colin,
    touches_on_colin,
    write_recorded_trial,
)
from Testing.slicer.simulator_double import connect_module

PROTOCOL = asset_path("studies", "published-protocol.json")
PLANNED = {"reachable": True, "reason": ""}
REPORTING = """
import pathlib, sys
pathlib.Path(sys.argv[-1], "report.html").write_text(" ".join(sys.argv[1:]))
"""
"""A simulator whose report only repeats its arguments."""


@pytest.fixture
def panels(fresh_module):
    """The module; a section is opened where something in it is used."""
    return fresh_module


@pytest.fixture
def study_path(panels):
    return panels.find("studyPathLineEdit").currentPath


@pytest.fixture
def add_trial(panels, make_record):
    """Returns a function that puts a scored trial on the built-in head into the study."""

    def add(number, trainee="T-001", **changes):
        started = f"2026-03-02T09:{number:02d}:00Z"
        trial_id = str(uuid.UUID(int=number))
        record = make_record(trial_id, trainee=trainee, startedUtc=started, **changes)
        store_trial_on_colin(panels, record, number)

    return add


def choose_trainee(host):
    host.press("createTraineeButton")
    host.choose("traineeComboBox", "T-001")


def choose_study(host, path):
    host.find("studyPathLineEdit").currentPath = str(path)
    host.process_events()
    return host.text("traineeText").replace("\u200b", "")


def use_program(host, folder, source):
    """Have the module use a program as its simulator."""
    program = folder / "rastrainer"
    program.write_text(f"#!{sys.executable}\n{source}", encoding="utf-8")
    program.chmod(0o755)
    host.find("programPathLineEdit").currentPath = str(program)
    host.process_events()


def test_a_trainee_is_created_chosen_archived_and_restored_here_or_in_another_slicer(
    panels, study_path
):
    for name in ("archiveButton", "exportTraineeButton", "deleteTraineeButton"):
        with pytest.raises(AssertionError, match="Choose a trainee first"):
            panels.press(name)
    with pytest.raises(AssertionError, match="Connect to the simulator first"):
        panels.press("startTaskButton")
    panels.press("createTraineeButton")
    assert panels.find("traineeComboBox").currentText == "T001"
    assert panels.find("pseudonymLineEdit").placeholderText == "T002"
    panels.check("consentCheckBox")
    panels.press("archiveButton")
    with Study.open(study_path) as study:
        (trainee,) = study.trainees(archived=True)
    assert (trainee.pseudonym, trainee.consent) == ("T001", True)
    assert panels.find("traineeComboBox").currentText == "T001 (archived)"
    panels.press("archiveButton")
    panels.check("archivedCheckBox", False)
    assert panels.find("traineeComboBox").currentText == "T001"
    panels.type("pseudonymLineEdit", "T001")
    panels.press("createTraineeButton")
    assert "taken; choose another" in panels.messages[-1].text
    # Another Slicer adds and deletes trainees.
    with Study.open(study_path) as study:
        study.create_trainee("Blue")
        study.delete_trainee("T001")
    combo = panels.find("traineeComboBox")
    panels.wait_until(lambda: combo.count == 2 and combo.itemText(1) == "Blue", "the list shows it")
    assert combo.currentText == "Choose a trainee"


def test_a_study_locked_by_another_program_is_reported_and_shown_again_automatically(
    panels, study_path, add_trial
):
    panels.press("createTraineeButton")
    other = sqlite3.connect(study_path, isolation_level=None)
    other.execute("BEGIN EXCLUSIVE")
    for button in ("archiveButton", "createTraineeButton"):
        panels.press(button)
        assert "Another program has locked the study" in panels.messages.pop().text
    panels.choose("traineeComboBox", "Choose a trainee")
    assert "Another program has locked the study" in panels.text("traineeText")
    other.execute("ROLLBACK")
    other.close()
    add_trial(1, "T-007")
    panels.wait_until(lambda: "nother program" not in panels.text("traineeText"), "it is shown")
    panels.choose("traineeComboBox", "T-007")
    assert panels.find("historyTable").rowCount == 1


def test_history_is_shown_plotted_and_exported_a_file_is_replaced_once_confirmed(
    panels, add_trial, tmp_path
):
    for number in (1, 2, 3):
        add_trial(number, completionTimeS=100.0 - number)
    choose_trainee(panels)
    rows = panels.cells("historyTable")
    assert [row[2:4] for row in rows] == [["Task 1", time] for time in ("99.0", "98.0", "97.0")]
    panels.press("learningCurveButton")
    chart = Role.LEARNING_CURVE.find(panels.scene)
    assert chart.GetNumberOfPlotSeriesNodes() == 2
    panels.press("calibrationButton")
    assert "3 trials have no true target error" in panels.text("traineeText")
    panels.press("calibrationButton")
    panels.answer("Export the trainee", str(tmp_path / "trainee"))
    panels.press("exportTraineeButton")
    assert len(json.loads((tmp_path / "trainee.json").read_text())["trials"]) == 3
    (tmp_path / "export.csv").write_text("mine")
    for answer in ("No", "Yes"):
        panels.answer("Export the history", str(tmp_path / "export"))
        panels.answer("already exists", answer)
        panels.press("exportHistoryButton")
        assert ((tmp_path / "export.csv").read_text() == "mine") == (answer == "No")
    with (tmp_path / "export.csv").open(newline="") as file:
        assert len(list(csv.DictReader(file))) == 3


def test_only_the_file_of_a_study_is_used_and_another_leaves_the_study_open(panels, tmp_path):
    panels.press("createTraineeButton")
    choose_study(panels, tmp_path / "second.db")
    assert panels.find("traineeComboBox").count == 1
    panels.press("createTraineeButton")
    letter, notes, new = tmp_path / "letter.db", tmp_path / "notes.txt", tmp_path / "typo/study.db"
    for path in (letter, notes):
        path.write_text("A letter to a friend. " * 300)
    for path, words in ((tmp_path, "is a folder"), (notes, "is no study")):
        said = choose_study(panels, path)
        assert f"{path.name} {words}" in said
        assert "second.db stays open" in said
    choose_study(panels, letter)
    assert "is not a study database" in panels.messages[-1].text
    for answer in ("No", "Yes"):
        assert panels.find("studyPathLineEdit").currentPath == str(tmp_path / "second.db")
        assert panels.find("traineeComboBox").count == 2
        panels.answer("There is no folder", answer)
        said = choose_study(panels, new)
        assert new.parent.is_dir() == (answer == "Yes")
    assert panels.find("studyPathLineEdit").currentPath == str(new)
    assert said.startswith("Choose who is training")
    # An unusable address is refused without its password.
    panels.type("studyAddressLineEdit", "postgresql://seat:secret@host/study")
    assert "must not hold a password" in panels.messages[-1].text
    assert "secret" not in panels.messages[-1].text
    panels.type("studyAddressLineEdit", "study.db")
    assert "An address looks like postgresql://" in panels.messages[-1].text
    assert panels.text("studyAddressLineEdit") == ""
    assert panels.find("studyPathLineEdit").enabled


def test_head_fiducials_and_robot_are_shown_and_another_model_can_be_the_head(panels):
    panels.choose("taskComboBox", "Task 2")
    panels.press("showScenarioButton")
    panels.finish_work()
    fixed = Role.FIXED_FIDUCIALS.find(panels.scene)
    assert fixed.GetName() == "Task 2 fiducials"
    panels.check("robotCheckBox")
    panels.finish_work()
    for role in (Role.HEAD_MODEL, *Role.LINKS):
        model = role.find(panels.scene)
        assert panels.sees(model), role.role
    former = Role.HEAD_MODEL.find(panels.scene)
    mine = panels.scene.AddNewNodeByClass("vtkMRMLModelNode", "Mine")
    mine.SetAndObservePolyData(former.GetPolyData())
    panels.choose("headModelComboBox", mine)
    panels.press("useHeadButton")
    assert Role.HEAD_MODEL.find(panels.scene) is mine
    assert not former.GetDisplayVisibility()
    panels.clear_scene()
    panels.wait_until(lambda: not panels.find("robotCheckBox").checked, "the box follows")


def test_a_plan_says_what_is_missing_until_it_can_be_sent_and_its_error_at_any_target(
    panels, simulator
):
    simulator.responder = lambda name, _arguments: PLANNED if name == "PlanTarget" else {}
    panels.press("showScenarioButton")
    panels.finish_work()
    with pytest.raises(AssertionError, match="Place a target or a trajectory"):
        panels.press("sendPlanButton")
    panels.press("placeTargetButton")
    with pytest.raises(AssertionError, match="has no point yet"):
        panels.press("sendPlanButton")
    setPoints(
        panels.find("planComboBox").currentNode(),
        ("Tumor", "Cyst"),
        np.array([[0.0, 0.0, 20.0], [60.0, 60.0, -60.0]]),
    )
    put_touches(panels, touches_on_colin())
    panels.wait_until(lambda: "target x" in panels.text("planWorldText"), "the plan is mapped")
    assert panels.find("planTargetComboBox").currentText == "Cyst"
    at_cyst = panels.text("planTreText")
    panels.choose("planTargetComboBox", "Tumor")
    assert "mm (95 %" in panels.text("planTreText") != at_cyst
    assert panels.find("planTreText").toolTip == toolTip(INTERVAL_NOTE)
    with pytest.raises(AssertionError, match="Connect to the simulator first"):
        panels.press("sendPlanButton")
    connect_module(panels, simulator)
    panels.press("sendPlanButton")
    panels.wait_until(lambda: "can carry it out" in panels.text("reachableText"), "the answer")
    panels.idle_for(0.3)
    assert "can carry it out" in panels.text("reachableText")
    panels.choose("planTargetComboBox", "Cyst")
    panels.wait_until(lambda: "show it again" in panels.text("reachableText"), "the hint")


def test_targets_are_added_removed_and_restored(panels):
    for place in ((10.0, 20.0, 0.0), (20.0, 10.0, 5.0)):
        panels.press("placeTargetButton")
        panels.place(*place)
    node = panels.find("planComboBox").currentNode()
    assert node.GetNumberOfControlPoints() == 2
    panels.wait_until(lambda: panels.find("planTargetComboBox").count == 2, "both are offered")
    panels.choose("planTargetComboBox", 0)
    panels.press("removePlanPointButton")
    assert node.GetNthControlPointPosition(0) == (20.0, 10.0, 5.0)
    panels.press("undoPlanButton")
    assert node.GetNthControlPointPosition(0) == (10.0, 20.0, 0.0)


def test_a_trial_is_scored_beside_the_reference_group_and_exported(
    panels, add_trial, study_path, tmp_path
):
    add_trial(1, motion={"sparc": -1.9})
    add_trial(2)
    choose_trainee(panels)
    assert panels.find("trialComboBox").currentText.startswith("2: Task 1")
    measures = [row[0] for row in panels.cells("scoreTable")]
    assert measures[0] == "Score"
    tip = panels.find("scoreTable").item(measures.index("Expected TRE"), 0).toolTip()
    assert "an offset that all touches share" in tip
    assert "CTPS as published" in [row[0] for row in panels.cells("ctpsTable")]
    assert "rises with a slower completion" in panels.text("ctpsText")
    groups = {row[2] for row in panels.cells("standingsTable")}
    assert groups == {"own", "reference"}
    panels.choose("trialComboBox", "1: Task 1")
    assert panels.cells("motionTable") == [["Smoothness, SPARC", "−1.90"]]
    panels.answer("Export all trials", str(tmp_path / "all.csv"))
    with Study.open(study_path) as study:
        study.change_trainee("T-001", consent=True)
    panels.press("exportScoresButton")
    assert len((tmp_path / "all.csv").read_text().splitlines()) == 3


def test_the_report_is_written_by_the_simulator_and_opened(panels, study_path, tmp_path):
    panels.press("reportButton")
    assert "is not set up yet: in the section Simulator, press Set up" in panels.messages[-1].text
    panels.find("programPathLineEdit").currentPath = "/nowhere/rastrainer"
    panels.press("startSimulatorButton")
    assert "There is no program" in panels.messages[-1].text
    use_program(panels, tmp_path, REPORTING)
    panels.answer("Folder for the report", str(tmp_path))
    panels.press("reportButton")
    page = tmp_path / "report.html"
    assert page.read_text() == f"report {study_path} -o {tmp_path}"
    assert panels.text("scoreMessageText") == f"The report is {page}."
    assert panels.messages[-1].text == page.as_uri()


def test_a_canceled_replay_or_one_whose_scene_is_closed_leaves_nothing_behind(panels, add_trial):
    trainee = panels
    add_trial(1)
    choose_trainee(panels)
    write_recorded_trial(Path.home() / "RASTrainer" / "trials", str(uuid.UUID(int=1)), 16.0)
    trainee.wait_until(lambda: trainee.text("feedbackText").startswith("Score "), "feedback")
    for meddle in (lambda: trainee.press("replayButton"), trainee.clear_scene):
        done = []

        def interfere_once(meddle=meddle, done=done):
            # Not before the first of the replay's nodes is in the scene.
            if trainee.scene.GetFirstNodeByName("T-001, task-1: WorldToHead") and not done:
                assert trainee.text("replayButton") == "Cancel"
                done.append(True)
                meddle()

        timer = QtCore.QTimer()
        timer.timeout.connect(interfere_once)
        timer.start(0)
        trainee.press("replayButton")
        timer.stop()
        assert done
        assert trainee.scene.GetFirstNodeByName("Replay of T-001, task-1") is None
        assert trainee.text("replayButton") == "Show the trial again"
    assert "The scene was changed" in trainee.messages[-1].text
    trainee.press("replayButton")
    assert trainee.scene.GetFirstNodeByName("Replay of T-001, task-1") is not None


def test_deleting_a_trainee_leaves_no_trace_in_database_journals_and_later_exports(
    panels, add_trial, study_path, tmp_path
):
    trial_id, trials = str(uuid.UUID(int=1)), Path.home() / "RASTrainer" / "trials"
    add_trial(1, motion={"sparc": -1.9})
    add_trial(2, "other")
    write_recorded_trial(trials, trial_id, 16.0)
    write_recorded_trial(trials, str(uuid.UUID(int=2)), 16.0, "other")
    (tmp_path / "later").mkdir()
    with Study.open(study_path) as study:
        for name in ("T-001", "other"):
            study.change_trainee(name, consent=True)
        progress = StudyProgress(study)
        progress.set_protocol(StudyProtocol.read(PROTOCOL))
        progress.enroll("T-001")
        progress.skip("T-001", "hmd/before/ssq", "a reason nobody else has")
        progress.practice("T-001", "hmd/trial-run", 9.0)
    words = (b"T-001", trial_id.encode(), b"a reason nobody else has")
    assert all(word in bytes_below(Path(study_path).parent, trials) for word in words)
    choose_trainee(panels)
    for answer in ("No", "Yes"):
        assert panels.find("historyTable").rowCount == 1
        panels.answer("Delete", answer)
        panels.press("deleteTraineeButton")
    assert "1 trials and 1 journals" in panels.text("traineeText")
    panels.answer("Export all trials", str(tmp_path / "later" / "all.csv"))
    panels.press("exportScoresButton")
    command = ["export", study_path, "-o", str(tmp_path / "later" / "exports")]
    assert main([*command, "--records", str(trials)]) == 0
    left = bytes_below(Path(study_path).parent, trials, tmp_path / "later")
    assert not [word for word in words if word in left]
    assert str(uuid.UUID(int=2)).encode() in left


def bytes_below(*folders):
    files = [path for folder in folders for path in folder.rglob("*") if path.is_file()]
    return b"".join(path.read_bytes() for path in files)
