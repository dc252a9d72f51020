"""The whole flow by a gamepad alone, in two hands or in one, from the start menu to the result."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.trial.wording import say
from rastrainer_simulator.flow import trial_screen
from rastrainer_simulator.input.bindings import LAYOUTS, LEFT_ALONE, RIGHT_ALONE
from rastrainer_simulator.input.inputs import InputDevice
from rastrainer_simulator.presentation.screen import Tone
from rastrainer_simulator.replay.resimulation import replay
from Testing.simulator.flow.test_controls_screens import open_the_bindings

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
            say("touch", label="3", residual=2.5, where=ABOVE, hurry="", shaking="").to_json(),
            {"key": "of another version", "values": {}, "text": "What only another one knows."},
            {"key": "passed", "values": {"mark": "high"}, "text": "You passed."},
            {"key": "passed", "values": {"mark": {"mark": {}}}, "text": 7},
        ],
    },
}


@pytest.fixture(scope="module")
def shared(simulation):
    return simulation


def train_and_view_the_result(trainee, outside, monkeypatch):
    trainee.until(lambda: trainee.item("trainee").value == "P07")
    assert not trainee.item("task-1").is_enabled
    monkeypatch.setattr(trial_screen, "TRIAL_RUN_S", 0.5)
    trainee.choose("trial-run", "practice")
    trainee.choose("finish", "experiment")
    trainee.choose("task-1", None)
    trainee.touch_anywhere()
    trainee.register()
    training = trainee.state.training
    assert (training.trainee, training.task, training.mode) == ("P07", "task-1", "desktop")
    outside.has_slicer = True
    assert trainee.submit("SubmitRegistration", trialId=training.trial_id, **REGISTRATION).ok
    assert trainee.submit("TrialScored", trialId=training.trial_id, **SCORE).ok
    trainee.until_menu("result")
    assert (trainee.menu.facts[0].value, trainee.menu.facts[0].tone) == (
        "81 / 100 (pass mark 82)",
        Tone.WARNING,
    )
    assert trainee.menu.paragraphs == (
        "Within all limits, but below the pass mark.",
        "Hold still before you touch.",
        "Point 3 was 2.5 mm off, mostly in depth (1.3 mm above the skin).",
        "What only another one knows.",
        "Point 3 is far off.",
    )
    trainee.choose("next", "experiment")
    assert trainee.menu.focus == "task-2"
    return training.trial_id


def test_the_whole_flow_is_done_with_a_gamepad_alone_and_its_trial_replays_bit_for_bit(
    pilot, outside, anywhere, tmp_path, monkeypatch
):
    pilot.choose("train", "introduction")
    pilot.tap("accept", "accept", "accept")
    pilot.until_menu("controls")
    pilot.choose("next", "experiment")
    pilot.choose("trainee", "keyboard")
    for row, steps in (("row1", 5), ("row3", 0), ("row3", 7)):
        pilot.focus(row)
        pilot.tap(*["right"] * steps, "accept")
    pilot.choose("done", "experiment")
    trial_id = train_and_view_the_result(pilot, outside, monkeypatch)
    (path,) = (tmp_path / "records").glob(f"*{trial_id}.journal")
    reading = read_journal(path)
    assert reading.integrity is Integrity.INTACT
    assert {entry["operator"] for entry in reading.of_kind("input")} <= {"gamepad", ""}
    assert replay(reading, anywhere).difference is None


def take_preset(pilot, preset):
    """Choose a layout on the page of the controls, with the usual one."""
    open_the_bindings(pilot)
    pilot.focus("preset")
    usual = pilot.item("preset").value
    while pilot.item("preset").value != preset:
        # The layout counts at once, for the next press, too: the D-pad leads through all of them.
        pilot.tap("right")
        assert pilot.item("preset").value != usual, f"there is no layout {preset}"


@pytest.mark.parametrize(
    ("preset", "title"), [(RIGHT_ALONE, "Right hand alone"), (LEFT_ALONE, "Left hand alone")]
)
def test_a_layout_for_one_hand_counts_as_soon_as_it_is_chosen(pilot, preset, title):
    take_preset(pilot, title)
    assert pilot.presenter.controls.bindings.gamepad == LAYOUTS[InputDevice.GAMEPAD][preset]
