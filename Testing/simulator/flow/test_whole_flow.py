"""From the start menu to the result (the paper's figure 4), against a real control loop."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.trial.wording import say
from rastrainer_simulator.flow import trial_screen
from rastrainer_simulator.net.views.screen import Tone
from rastrainer_simulator.replay.resimulation import replay

ABOVE = say("touch above", depth=1.25)
REGISTRATION = {
    "matrix": np.eye(4).ravel().tolist(),
    "freMm": 1.25,
    "expectedTreMm": 1.5,
}
SCORE = {
    "score": 81.0,
    "details": {
        "ctps": 62.5,
        "passMark": 82.0,
        "warnings": ["Point 3 is far off."],
        "feedback": [
            "Hold still before you touch.",
            7,
            say("touch", label="3", residual=2.5, where=ABOVE, hurry="", tremor="").to_json(),
            {"key": "of another version", "values": {}, "text": "What only another one knows."},
            {"key": "passed", "values": {"mark": "high"}, "text": "You passed."},
            {"key": "passed", "values": {"mark": {"mark": {}}}, "text": 7},
        ],
    },
}


def go_to_the_experiment_menu(trainee):
    trainee.choose("train")
    trainee.until_menu("introduction")
    trainee.tap("accept", "accept", "accept")
    trainee.until_menu("controls")
    trainee.choose("next")
    trainee.until_menu("experiment")


def train_and_look_at_the_result(trainee, outside, monkeypatch):
    trainee.until(lambda: trainee.item("trainee").value == "P07")
    assert not trainee.item("task-1").is_enabled
    monkeypatch.setattr(trial_screen, "TRIAL_RUN_S", 0.5)
    trainee.choose("trial-run")
    trainee.until_menu("practice")
    trainee.choose("finish")
    trainee.until_menu("experiment")
    trainee.choose("task-1")
    trainee.until_menu(None)
    trainee.play("task-1")
    trainee.register()
    training = trainee.state.training
    assert (training.trainee, training.task, training.mode) == ("P07", "task-1", "desktop")
    outside.has_slicer = True
    assert trainee.submit("SubmitRegistration", trialId=training.trial_id, **REGISTRATION).ok
    assert trainee.submit("TrialScored", trialId=training.trial_id, **SCORE).ok
    trainee.until_menu("result")
    assert (trainee.menu.facts[0].value, trainee.menu.facts[0].tone) == ("81 / 100", Tone.PLAIN)
    assert trainee.menu.paragraphs == (
        "Point 3 is far off.",
        "Hold still before you touch.",
        "Point 3 was 2.5 mm off, mostly in depth (1.3 mm above the skin).",
        "What only another one knows.",
        "You passed.",
        "The expected error assumes independent, unbiased, equally large touch errors. It cannot "
        "detect an offset that all touches share.",
    )
    trainee.choose("next")
    trainee.until_menu("experiment")
    assert trainee.menu.focus == "task-2"
    return training.trial_id


@pytest.mark.soak
def test_the_whole_flow_goes_by_keys_alone(trainee, outside, monkeypatch):
    go_to_the_experiment_menu(trainee)
    trainee.focus("trainee")
    trainee.hands.type("P07")
    train_and_look_at_the_result(trainee, outside, monkeypatch)


def test_the_whole_flow_goes_by_a_gamepad_alone_and_its_trial_replays_bit_by_bit(
    pilot, outside, setup, tmp_path, monkeypatch
):
    go_to_the_experiment_menu(pilot)
    pilot.choose("trainee")
    pilot.until_menu("keyboard")
    for row, steps in (("row1", 5), ("row3", 0), ("row3", 7)):
        pilot.focus(row)
        pilot.tap(*["right"] * steps, "accept")
    pilot.choose("done")
    pilot.until_menu("experiment")
    trial_id = train_and_look_at_the_result(pilot, outside, monkeypatch)
    (path,) = (tmp_path / "records").glob(f"*{trial_id}.journal")
    reading = read_journal(path)
    assert reading.integrity is Integrity.INTACT
    assert reading.header["trainee"] == "P07"
    assert {entry["operator"] for entry in reading.of_kind("input")} <= {"gamepad", ""}
    assert replay(reading, setup).is_identical
