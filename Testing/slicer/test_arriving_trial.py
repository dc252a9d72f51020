"""A trial arrives in the module as Slicer runs it: the main thread keeps Python's lock."""

import os
import sys
import uuid
from pathlib import Path

import numpy as np
import pytest
import slicer

from Testing.slicer.host.opened_journals import OpenedJournals
from Testing.slicer.host.scene_load import SceneLoad
from Testing.slicer.recorded_trial import COLIN27, touches_on_colin, write_recorded_trial

SEED = 3
TRIAL = str(uuid.UUID(int=9))


@pytest.fixture
def connected(host, simulator):
    """The module with a chosen trainee and a simulator that has recorded their trial."""
    write_recorded_trial(Path.home() / "RASTrainer" / "trials", TRIAL, 16.0)

    def answer(name, _arguments):
        head_to_world = COLIN27.perturbed_head_to_world(SEED).ravel().tolist()
        truth = {"headToWorld": head_to_world, "trueTreMm": 0.5}
        return truth if name == "SubmitRegistration" else {}

    simulator.responder = answer
    host.open()
    host.type("pseudonymLineEdit", "T-001")
    host.press("createTraineeButton")
    host.widget.logic.session.link.connectTo(port=simulator.port)
    host.wait_until(lambda: simulator.commands, "it is connected")
    return host


@pytest.fixture
def record(make_record):
    record = make_record(TRIAL, scenario="colin27")
    for point, position in zip(record["points"], touches_on_colin(SEED).tolist(), strict=True):
        point["positionMm"] = position
    return record


@pytest.fixture
def journals(connected):  # noqa: ARG001 (Slicer runs)
    """The processes that read journals."""
    opened = OpenedJournals(Path(slicer.app.slicerHome))
    yield opened
    opened.close()


@pytest.mark.usefixtures("own_processes")
def test_a_trial_is_stored_scored_and_assessed_while_the_window_stays_responsive(
    connected, simulator, record, journals
):
    host = connected
    host.keeps_lock = True
    with SceneLoad(host.scene) as load:
        simulator.send_command("TrialCompleted", record)
        host.wait_until(lambda: host.find("historyTable").rowCount == 1, "the trial is stored")
        host.wait_until(lambda: host.text("feedbackText").startswith("Score "), "it is assessed")
        host.finish_work()
    # It is shown in turns: a table of the scene comes with its plot and that with its series.
    assert host.scene.GetFirstNodeByName("Task 1 fiducials") is not None
    assert load.most.nodes <= 4
    assert load.total.nodes >= 18
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


def test_a_trial_that_is_not_scored_still_gets_feedback(connected, simulator, record):
    simulator.responder = lambda name, _arguments: (
        "Another registration was submitted." if name == "SubmitRegistration" else {}
    )
    simulator.send_command("TrialCompleted", record)
    feedback = lambda: connected.text("feedbackText")  # noqa: E731
    connected.wait_until(
        lambda: feedback().startswith(("Point ", "No touch ")), "the feedback is shown"
    )
