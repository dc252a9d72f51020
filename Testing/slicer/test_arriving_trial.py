"""A trial arrives in the module as Slicer runs it: the main thread keeps Python's lock."""

import os
import sys
import uuid
from pathlib import Path

import numpy as np
import pytest
import slicer

from rastrainer import transforms
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from Testing.slicer.host.opened_journals import OpenedJournals
from Testing.slicer.host.scene_load import SceneLoad
from Testing.slicer.recorded_trial import write_recorded_trial

pytestmark = pytest.mark.usefixtures("own_processes")

SEED = 3
TRIAL = str(uuid.UUID(int=9))


@pytest.fixture
def head_to_world():
    return load_scenario(asset_path("scenarios", "colin27")).perturbed_head_to_world(SEED)


@pytest.fixture
def connected(host, simulator, head_to_world):
    """The module with a chosen trainee and a simulator that has recorded their trial."""
    write_recorded_trial(Path.home() / "RASTrainer" / "trials", TRIAL, 16.0)

    def answer(name, _arguments):
        truth = {"headToWorld": head_to_world.ravel().tolist(), "trueTreMm": 0.5}
        return truth if name == "SubmitRegistration" else {}

    simulator.responder = answer
    host.open()
    host.type("pseudonymLineEdit", "T-001")
    host.press("createTraineeButton")
    host.widget.logic.session.link.connectTo(port=simulator.port)
    host.wait_until(lambda: simulator.commands, "it is connected")
    return host


@pytest.fixture
def record(make_record, head_to_world):
    """A trial whose touches are exact."""
    colin = load_scenario(asset_path("scenarios", "colin27"))
    touched = transforms.apply(head_to_world, colin.task("task-1").fiducials)
    record = make_record(TRIAL, scenario="colin27")
    for point, position in zip(record["points"], touched.tolist(), strict=True):
        point["positionMm"] = position
    return record


@pytest.fixture
def journals(connected):  # noqa: ARG001 (Slicer runs)
    """The processes that read journals."""
    opened = OpenedJournals(Path(slicer.app.slicerHome))
    yield opened
    opened.close()


def test_a_trial_is_stored_scored_and_assessed_while_the_window_stays_responsive(
    connected, simulator, record, journals
):
    host = connected
    host.keeps_lock = True
    simulator.send_command("TrialCompleted", record)
    host.wait_until(lambda: host.find("historyTable").rowCount == 1, "the trial is stored")
    host.wait_until(lambda: host.text("feedbackText").startswith("Score "), "the feedback is shown")
    assert [name for name, _arguments in simulator.commands if name != "Hello"] == [
        "AcknowledgeTrial",
        "SubmitRegistration",
        "TrialScored",
    ]
    true_error = lambda: host.find("historyTable").item(0, 4).text()  # noqa: E731
    host.wait_until(lambda: true_error() != "–", "the history shows the true error")
    assert np.isfinite(float(true_error()))
    # The journal is read once, and where there is Slicer's Python, by a process of it.
    (pid,) = journals.pids()
    assert (pid == os.getpid()) is (sys.platform == "win32")
    # Nothing is left to do, and no timer runs for it.
    host.wait_until(lambda: not host.widget._workTimer.active, "the work is done")


def test_a_trial_that_is_not_scored_still_gets_feedback(connected, simulator, record, journals):
    simulator.responder = lambda name, _arguments: (
        "Another registration was submitted." if name == "SubmitRegistration" else {}
    )
    simulator.send_command("TrialCompleted", record)
    feedback = lambda: connected.text("feedbackText")  # noqa: E731
    connected.wait_until(
        lambda: feedback().startswith(("Point ", "No touch ")), "the feedback is shown"
    )
    assert len(journals.pids()) == 1


def test_a_trial_is_shown_in_turns_of_few_nodes_each(connected, simulator, record):
    host = connected
    with SceneLoad(host.scene) as load:
        simulator.send_command("TrialCompleted", record)
        host.wait_until(lambda: host.find("trialComboBox").count, "it is scored")
        host.finish_work()
    assert host.scene.GetFirstNodeByName("Task 1 fiducials") is not None
    # A table of the scene comes with its plot and that with its series.
    assert load.most.nodes <= 4
    assert load.total.nodes >= 18
