"""The section Registration: fits, errors, touches weighted or left out, faults, replays."""

import uuid
from pathlib import Path

import numpy as np
import pytest
import slicer
from PySide6 import QtWidgets

from rastrainer.registration.registration import register
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.scenario.points import LABELS
from rastrainer.slicer.scene.nodes import Role, setPoints
from rastrainer.study.outcomes import task_title
from rastrainer.transforms import MM_PER_M
from rastrainer.widgets.plain_text import toolTip
from Testing.slicer.recorded_trial import (
    COLIN27,
    put_touches,
    store_trial_on_colin,
    touches_on_colin,
    write_recorded_trial,
)
from Testing.slicer.test_images_in_module import show_scenario
from Testing.slicer.told_module import ToldModule

ALL = ", ".join(LABELS)


@pytest.fixture(scope="module")
def shown(lasting_host):
    """The module with the fiducials of task 1 and the images in the scene."""
    show_scenario(lasting_host)
    return lasting_host


@pytest.fixture
def panels(shown):
    """The same without touches, and with the usual choices."""
    setPoints(Role.CAPTURED_POINTS.make(shown.scene), (), np.zeros((0, 3)))
    shown.choose("kindComboBox", "Rigid")
    shown.finish_work()
    yield shown
    assert shown.errors == []


@pytest.fixture
def touched():
    """Touches of the task, (15, 3) float, World, mm, which are not yet in the scene."""
    return touches_on_colin()


def test_fits_and_errors_are_shown_with_their_units_and_fit_and_target_are_chosen(panels, touched):
    put_touches(panels, touched)
    rows = panels.cells("fitsTable")
    assert [row[0] for row in rows] == ["Rigid", "Similarity", "Affine"]
    assert "Expected TRE at the target" in panels.text("treText")
    tips = (panels.find("treText").toolTip, panels.find("fitsTable").item(0, 3).toolTip())
    assert tips == (toolTip(INTERVAL_NOTE),) * 2
    transform = Role.WORLD_TO_HEAD.find(panels.scene)
    rigid = slicer.util.arrayFromTransformMatrix(transform)
    panels.choose("kindComboBox", "Similarity")
    panels.finish_work()
    similar = slicer.util.arrayFromTransformMatrix(transform)
    assert np.linalg.det(rigid[:3, :3]) == pytest.approx(1.0)
    assert np.linalg.det(similar[:3, :3]) != pytest.approx(1.0, abs=1e-6)
    points = Role.CAPTURED_POINTS.make(panels.scene)
    assert panels.find("appliedCheckBox").checked
    panels.check("appliedCheckBox", False)
    assert points.GetParentTransformNode() is None
    panels.check("appliedCheckBox")
    assert points.GetParentTransformNode().GetName() == "WorldToHead"
    points.SetAndObserveTransformNodeID(None)
    panels.wait_until(lambda: not panels.find("appliedCheckBox").checked, "the box follows")
    before = panels.text("treText")
    target = panels.scene.AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "Tumor")
    target.AddControlPoint(60.0, 60.0, -60.0)
    panels.choose("targetComboBox", target)
    panels.wait_until(lambda: panels.text("treText") != before, "the error is updated")
    panels.scene.RemoveNode(target)


def test_the_chosen_fiducial_is_shown_in_the_slices_weighted_and_left_out(panels, touched):
    touched[2] += [2.0, -1.0, 0.5]
    put_touches(panels, touched)
    before = panels.cells("residualsTable")
    with pytest.raises(AssertionError, match="Choose a row"):
        panels.press("fleButton")
    view = panels.scene.AddNewNodeByClass("vtkMRMLSliceNode", "Mine")
    panels.choose("residualsTable", 2)
    panels.finish_work()
    height = COLIN27.task("task-1").fiducials[2, 2]
    assert view.GetSliceToRAS().GetElement(2, 3) == pytest.approx(height, abs=1e-3)
    panels.type("fleSpinBox", "20")
    panels.press("fleButton")
    panels.finish_work()
    after = panels.cells("residualsTable")
    assert after[2][3] == "20.00"
    # A point of little weight lies where the others put it, fitted or left out.
    assert float(after[2][1]) == pytest.approx(float(after[2][2]), abs=0.02)
    assert "weighted by the stated FLE; the score" in panels.text("registrationText")
    panels.press("undoButton")
    panels.finish_work()
    assert panels.cells("residualsTable") == before
    panels.press("excludeButton")
    panels.finish_work()
    assert "Left out: 3" in panels.text("registrationText")


def warnings(host):
    labels = host.find("warningsWidget")._qt.findChildren(QtWidgets.QLabel)
    return [label.text() for label in labels]


def test_one_click_fixes_a_fault_and_undo_reverts_it(panels, touched):
    bad = touched + np.outer(np.arange(15) == 6, [9.0, -6.0, 5.0])
    for case, points, named, button, count in (
        ("reversed", touched[::-1], f"({ALL}) are in reverse order", "Put in order", 15),
        ("one bad touch", bad, "Point 7 lies", "Leave out 7", 14),
    ):
        put_touches(panels, points)
        assert named in " ".join(warnings(panels)), case
        number = next(n for n, text in enumerate(warnings(panels)) if named in text)
        assert panels.text(f"remedy{number}Button") == button, case
        panels.press(f"remedy{number}Button")
        panels.finish_work()
        assert named not in " ".join(warnings(panels)), case
        assert panels.find("residualsTable").rowCount == count, case
        panels.press("undoButton")
        panels.finish_work()
        assert named in " ".join(warnings(panels)), case
        assert panels.find("residualsTable").rowCount == 15, case


def test_a_warning_without_a_remedy_names_its_points_and_good_touches_raise_none(panels, touched):
    for points, named, advice in (
        (touched * [1, 1, -1], f"({ALL}) are a mirror image", "check the sign"),
        (touched / MM_PER_M, f"({ALL}) are 998.9 times", "must be in millimeters"),
        (touched[:2], "", "at least 3"),
    ):
        put_touches(panels, points)
        text = " ".join([*warnings(panels), panels.text("registrationText")])
        assert named in text
        assert advice in text
    put_touches(panels, touched)
    assert warnings(panels) == []


@pytest.fixture
def trials(panels, make_record, tmp_path):
    """The module with a recorded trial of each of two tasks; their own FRE, mm, by task."""
    panels.begin_anew(tmp_path / "study.db")
    fre = {}
    for number, task in enumerate(("task-1", "task-2"), start=1):
        trial_id, started = str(uuid.UUID(int=number)), f"2026-03-02T09:0{number}:00Z"
        record = make_record(trial_id, trainee="T001", task=task, startedUtc=started)
        touched = store_trial_on_colin(panels, record, number)
        fre[task] = register(touched, COLIN27.task(task).fiducials).fre_mm
        write_recorded_trial(Path.home() / "RASTrainer" / "trials", trial_id)
    panels.press("createTraineeButton")
    panels.choose("traineeComboBox", "T001")
    return fre


def replay(host, trials, number, task):
    """Replay a trial and wait until its own touches are registered."""
    host.choose("trialComboBox", f"{number}: {task_title(task)}")
    host.press("replayButton")
    expected = pytest.approx(trials[task], abs=0.01)
    host.wait_until(lambda: shown_fre(host) == expected, f"the touches of {task} are registered")
    assert host.find("residualsTable").rowCount == 15


def shown_fre(host):
    shown = host.find("fitsTable").item(0, 1)
    return None if shown is None else float(shown.text())


def test_a_replay_registers_its_touches_to_its_own_tasks_fiducials_but_not_during_a_trial(
    panels, trials, simulator
):
    replay(panels, trials, 1, "task-1")
    replay(panels, trials, 2, "task-2")
    # They are not paired with another task's fiducials.
    panels.choose("taskComboBox", "Task 1")
    panels.press("showScenarioButton")
    panels.wait_until(
        lambda: "show the task" in panels.text("registrationText"), "the message is shown"
    )
    assert panels.find("fitsTable").item(0, 1) is None
    panels.choose("taskComboBox", "Task 2")
    panels.press("showScenarioButton")
    panels.wait_until(lambda: panels.find("residualsTable").rowCount == 15, "they are registered")
    # A trial in progress is not disturbed, and begins without the replay's touches.
    tasks = {"scenario": "colin27", "title": "Colin", "tasks": []}
    simulator.responder = lambda name, _arguments: tasks if name == "ListTasks" else {}
    told = ToldModule(panels, simulator)
    told.tell(task="task-2")
    captured = Role.CAPTURED_POINTS.make(panels.scene)
    panels.wait_until(lambda: captured.GetNumberOfControlPoints() == 0, "the trial begins")
    assert captured.GetDisplayNode().GetVisibility()
    panels.press("replayButton")
    assert "A trial is in progress" in panels.messages[-1].text
    panels.press("connectButton")
    panels.press("replayButton")
    assert len(panels.messages) == 1
