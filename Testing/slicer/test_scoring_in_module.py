"""A trial arrives in the module as Slicer runs it: the main thread keeps Python's lock."""

import uuid
from pathlib import Path

import numpy as np

from rastrainer import transforms
from rastrainer.scenario.scenario import load_scenario
from rastrainer_simulator.assets import asset_path
from Testing.slicer.recorded_trial import write_recorded_trial

SEED = 3
TRIAL = str(uuid.UUID(int=9))


def test_a_trial_is_kept_scored_and_judged_while_the_window_answers(host, simulator, make_record):
    colin = load_scenario(asset_path("scenarios", "colin27"))
    head_to_world = colin.perturbed_head_to_world(SEED)
    touched = transforms.apply(head_to_world, colin.task("task-1").fiducials)
    record = make_record(TRIAL, scenario="colin27")
    for point, position in zip(record["points"], touched.tolist(), strict=True):
        point["positionMm"] = position

    def answer(name, _arguments):
        truth = {"headToWorld": head_to_world.ravel().tolist(), "trueTreMm": 0.5}
        return truth if name == "SubmitRegistration" else {}

    simulator.responder = answer
    write_recorded_trial(Path.home() / "RASTrainer" / "trials", TRIAL, 16.0)
    host.open()
    host.type("pseudonymLineEdit", "T-001")
    host.press("createTraineeButton")
    link = host.widget.logic.session.link
    link.connectTo(port=simulator.port)
    host.wait_until(lambda: simulator.commands, "it is connected")
    host.keeps_lock = True
    simulator.send_command("TrialCompleted", record)
    host.wait_until(lambda: host.find("historyTable").rowCount == 1, "the trial is kept")
    host.wait_until(lambda: host.text("feedbackText").startswith("Score "), "it is judged")
    assert [name for name, _arguments in simulator.commands if name != "Hello"] == [
        "AcknowledgeTrial",
        "SubmitRegistration",
        "TrialScored",
    ]
    true_error = lambda: host.find("historyTable").item(0, 4).text()  # noqa: E731
    host.wait_until(lambda: true_error() != "–", "the history shows the true error")
    assert np.isfinite(float(true_error()))
    # Nothing is left to do, and no timer runs for it.
    host.wait_until(lambda: not host.widget._workTimer.active, "the work is done")
