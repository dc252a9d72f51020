"""The whole flow by a gamepad alone, in two hands or in one, from the start menu to the result."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.trial.wording import say
from rastrainer_simulator.flow import trial_screen
from rastrainer_simulator.input.bindings import LAYOUTS, LEFT_ALONE, RIGHT_ALONE
from rastrainer_simulator.input.inputs import ControlName, InputDevice
from rastrainer_simulator.presentation.screen import Tone
from rastrainer_simulator.replay.resimulation import replay
from Testing.simulator.flow.test_controls_screens import open_the_bindings
from Testing.simulator.flow.trainee import Pad
from Testing.simulator.input.test_bindings import REACH

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
    assert reading.header.trainee == "P07"
    assert {entry["operator"] for entry in reading.of_kind("input")} <= {"gamepad", ""}
    assert replay(reading, anywhere).difference is None


AXIS_OF = {RIGHT_ALONE: "right", LEFT_ALONE: "left"}


class OneHand(Pad):
    """One hand at a gamepad; it presses nothing that it does not reach.

    Its thumb pushes the stick or presses up or down, not both.
    """

    def __init__(self, trainee, plugged, preset):
        super().__init__(trainee, plugged)
        self._side = AXIS_OF[preset]
        self._reach = REACH[InputDevice.GAMEPAD, preset]
        self._table = LAYOUTS[InputDevice.GAMEPAD][preset]
        self._pressed = None

    def tap(self, control):
        self._press(ControlName(control), True)
        self._trainee.step()
        self._press(ControlName(control), False)
        self._trainee.step()

    def push(self, right, forward, up, fine):
        is_upright = abs(up) > max(abs(right), abs(forward))
        control = (
            (ControlName.MOVE_UP if up > 0.0 else ControlName.MOVE_DOWN) if is_upright else None
        )
        if self._pressed not in (None, control):
            self._press(self._pressed, False)
        if control is not None:
            self._press(control, True)
        self._pressed = control
        level = (0.0, 0.0) if is_upright else (right, -forward)
        axes = dict(zip((f"{self._side}x", f"{self._side}y"), level, strict=True))
        axes[f"{self._side}trigger"] = float(fine)
        self.plugged.move(**axes)

    def _press(self, control, is_down):
        name = next(each for each in self._table[control] if each in self._reach)
        if name.startswith("+"):
            self.plugged.move(**{name[1:]: float(is_down)})
        elif name.startswith("-"):
            self.plugged.move(**{name[1:]: -float(is_down)})
        else:
            self.plugged.press(name, is_down)


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
    ("preset", "title"),
    [
        pytest.param(RIGHT_ALONE, "Right hand alone", id="right"),
        pytest.param(LEFT_ALONE, "Left hand alone", id="left", marks=pytest.mark.soak),
    ],
)
def test_one_hand_works_the_menus_and_touches_points(pilot, tmp_path, preset, title):
    take_preset(pilot, title)
    pilot.hands = OneHand(pilot, pilot.hands.plugged, preset)
    while pilot.menu.name != "start":
        before = pilot.menu.name
        pilot.tap("back")
        pilot.until(lambda b=before: pilot.menu.name != b, "the previous menu")
    pilot.start("task-1")
    start = pilot.tip
    pilot.touch_anywhere()
    assert min(np.abs(np.subtract(pilot.tip, start))) > 0.002, "moved in all directions"
    pilot.tap("undo")
    pilot.until(lambda: pilot.touched == 14, "the undo")
    (path,) = (tmp_path / "records").glob("*.journal")
    entries = read_journal(path).of_kind("input")
    assert {entry["operator"] for entry in entries} <= {"gamepad", ""}
