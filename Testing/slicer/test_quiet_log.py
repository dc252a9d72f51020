"""A user's whole work leaves no error and no warning in Slicer's log: the host fails at each."""

import uuid
from pathlib import Path

import pytest
import slicer

from rastrainer.scenario.points import LABELS
from rastrainer.slicer.scene.nodes import Role, setPoints
from rastrainer.slicer.scene.trial_replay import findReplay
from Testing.slicer.recorded_trial import store_trial_on_colin, write_recorded_trial


@pytest.fixture
def at_work(host, make_record):
    """The module with a recorded trial in the study, and its touches in the scene."""
    host.open()
    host.unfold("residualsTable")
    record = make_record(str(uuid.UUID(int=1)), trainee="T001", scenario="colin27")
    touched = store_trial_on_colin(host, record, 5)
    write_recorded_trial(Path.home() / "RASTrainer" / "trials", record["trialId"], 4.0)
    host.press("createTraineeButton")
    host.choose("traineeComboBox", "T001")
    host.press("showScenarioButton")
    setPoints(Role.CAPTURED_POINTS.make(host.scene), LABELS, touched)
    host.wait_until(lambda: host.find("residualsTable").rowCount == 15, "touches are registered")
    return host


def entries():
    """The entries of Slicer's log from warnings on."""
    text = Path(slicer.app.errorLogModel().filePath).read_text(encoding="utf-8")
    return [line for line in text.splitlines() if not line.startswith("[INFO]")]


def test_an_error_of_input_is_one_line_of_the_log_and_a_mistake_of_ours_its_traceback(
    host, monkeypatch
):
    host.open()
    for _time in range(2):
        host.type("pseudonymLineEdit", "T001")
        host.press("createTraineeButton")
    message = host.messages[-1].text
    assert message.startswith("The trainee was not created.\n\n")
    (line,) = entries()
    assert line.startswith("[ERROR]")
    assert line.endswith(" ".join(message.split()))
    monkeypatch.setattr(host.widget.logic.session.trainees, "create", None)
    host.press("createTraineeButton")
    assert host.messages[-1].text.startswith("The trainee was not created.\n\n")
    assert any(line.startswith("[CRITICAL]") for line in entries())
    assert "TypeError" in host.errors.pop()


def test_replaying_saving_coloring_planning_plotting_and_closing_leave_the_log_empty(
    at_work, tmp_path
):
    at_work.press("replayButton")
    at_work.save_scene(tmp_path / "replay.mrb")
    at_work.load_scene(tmp_path / "replay.mrb")
    assert findReplay(at_work.scene).GetNumberOfItems() > 30
    for _round in range(2):
        at_work.check("headColoredCheckBox")
        at_work.check("headColoredCheckBox", False)
        at_work.press("placeTrajectoryButton")
        at_work.place(0.0, 0.0, 90.0)
        at_work.place(0.0, 0.0, 30.0)
        at_work.press("learningCurveButton")
        at_work.press("showTablesButton")
        at_work.clear_scene()
        at_work.press("showScenarioButton")
    at_work.delete_nodes()
    assert at_work.errors == []
