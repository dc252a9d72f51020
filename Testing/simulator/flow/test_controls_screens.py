"""Gamepads that are unplugged, operators that join, and controls that are rebound on the screen."""

from __future__ import annotations

import json

import numpy as np
import pytest

from rastrainer_simulator.flow.running_presenter import RunningPresenter
from rastrainer_simulator.input.bindings import BINDINGS_FILE, DEFAULT_BINDINGS, read_bindings
from rastrainer_simulator.input.inputs import ControlName
from rastrainer_simulator.presentation.messages import Hello
from rastrainer_simulator.texts.texts import Texts, input_label


def tip(trainee):
    return np.array(trainee.tip)


def test_unplugging_the_gamepad_in_use_stops_robot_and_clock_until_the_trial_is_resumed(
    pilot,
):
    pilot.start("task-1")
    pilot.hands.push(0.6, 0.0, 0.3, False)
    before = tip(pilot)
    pilot.step(20)
    assert np.linalg.norm(tip(pilot) - before) > 0.002
    pilot.hands.plugged.unplug()
    pilot.step()
    stopped = tip(pilot)
    pilot.step(15)
    assert np.array_equal(tip(pilot), stopped)
    pilot.until_menu("trial")
    assert "unplugged: the robot has stopped" in str(pilot.presenter.screen.warnings)
    assert pilot.presenter.control.holder == ""
    elapsed = pilot.state.elapsed
    pilot.hands.plugged.plug_in()
    pilot.step(20)
    assert pilot.state.elapsed == elapsed
    assert "robot has stopped" not in str(pilot.presenter.screen.warnings)
    pilot.choose("resume", None)
    assert pilot.presenter.screen.warnings == ()
    pilot.hands.push(0.6, 0.0, 0.0, False)
    pilot.step(20)
    assert np.linalg.norm(tip(pilot) - stopped) > 0.002


def test_a_stick_held_while_a_menu_closes_does_not_move_the_arm_until_released(pilot):
    pilot.start("task-1")
    pilot.tap_until("menu", "trial")
    pilot.hands.push(0.8, 0.0, 0.0, False)
    pilot.step(5)
    pilot.submit("Resume")
    pilot.until_menu(None)
    still = tip(pilot)
    pilot.step(20)
    assert np.array_equal(tip(pilot), still)
    pilot.hands.push(0.0, 0.0, 0.0, False)
    pilot.step(2)
    pilot.hands.push(0.8, 0.0, 0.0, False)
    pilot.step(20)
    assert not np.array_equal(tip(pilot), still)


@pytest.mark.parametrize(
    ("lose", "why"),
    [
        (lambda presenter: presenter.view_left(1), "was closed or lost"),
        (lambda presenter: presenter.on_visibility(1, False), "out of sight"),
        (lambda presenter: presenter.on_silence(1), "the picture froze"),
    ],
)
def test_a_trial_that_nobody_could_see_is_paused_and_says_why_until_it_resumes(trainee, lose, why):
    trainee.start("task-1")
    lose(trainee.presenter)
    trainee.until_menu("trial")
    assert why in trainee.presenter.screen.warnings[0].text
    trainee.submit("Resume")
    trainee.until_menu(None)
    trainee.submit("Pause")
    trainee.until_menu("trial")
    assert trainee.presenter.screen.warnings == ()


def test_a_headset_that_reconnects_as_another_view_is_the_one_being_worn(trainee):
    presenter = trainee.presenter
    for view in (5, 6):
        presenter.view_joined(view, Hello("headset", "Quest 3", 90.0))
        presenter.on_silence(5)
    trainee.start("task-1")
    presenter.view_left(5)
    trainee.step(20)
    assert trainee.menu is None
    presenter.on_visibility(6, False)
    trainee.until_menu("trial")


def test_a_free_key_can_be_assigned_to_a_control_and_is_kept(trainee, outside):
    open_the_bindings(trainee)
    trainee.choose("touch", "listen")
    trainee.hands.key("KeyY")
    trainee.until_menu("bindings")
    trainee.step(20)
    assert trainee.item("touch").value == "Y"
    assert trainee.presenter.screen.warnings[0].text == "Touch is now Y."
    saved = read_bindings(outside.services.config / BINDINGS_FILE)
    assert saved.keyboard[ControlName.TOUCH] == ("KeyY",)
    trainee.choose("defaults")
    trainee.step()
    assert read_bindings(outside.services.config / BINDINGS_FILE) == DEFAULT_BINDINGS


def test_a_key_already_in_use_is_exchanged_only_on_request(trainee):
    open_the_bindings(trainee)
    for answer, labels in (("cancel", ("Space, Enter", "C")), ("exchange", ("C", "Space"))):
        trainee.choose("touch", "listen")
        trainee.hands.key("KeyC")
        trainee.until_menu("conflict")
        trainee.choose(answer, "bindings")
        trainee.step(20)
        assert (trainee.item("touch").value, trainee.item("camera").value) == labels


AZERTY = {"KeyW": "z", "KeyA": "q", "KeyS": "s", "KeyD": "d", "Minus": "ß", "Space": " "}


def test_keys_are_named_as_on_the_operators_keyboard(trainee):
    def forward():
        return trainee.presenter._session.operator.label(ControlName.MOVE_FORWARD)

    trainee.presenter.on_layout(1, AZERTY)
    trainee.start("task-1")
    trainee.tap("camera")
    trainee.step(20)
    hints = [(hint.control, hint.action) for hint in trainee.presenter.screen.hints[:2]]
    assert hints == [("Z Q S D", "Move"), ("R / F", "Up, down")]
    names = {"KeyQ": "Q", "Digit1": "1", "Minus": "ß", "Space": "Space"}
    assert {code: input_label(Texts(), "keyboard", code, AZERTY) for code in names} == names
    # Another page's keyboard is not theirs, and a page that has left is forgotten.
    trainee.presenter.view_joined(2, Hello("page"))
    trainee.presenter.on_layout(2, {"KeyW": "ц"})
    trainee.hands.key("KeyE")
    assert forward() == "Z"
    trainee.presenter.view_left(1)
    assert forward() == "Ц"
    trainee.presenter.view_left(2)
    assert forward() == "W"


def test_the_test_screen_shows_every_stick_and_button_as_it_moves(pilot):
    pilot.choose("controls", "controls")
    pilot.choose("test", "test")
    pilot.hands.push(0.5, -1.0, 0.25, True)
    pilot.hands.plugged.press("x")
    pilot.step(20)
    values = [item.value for item in pilot.menu.items if item.kind == "axis"]
    assert values == ["0.50", "-1.00", "0.25", "0.00", "0.00"]
    assert pilot.menu.facts[0].value == "On"
    assert ("X", "Best view") in [(fact.label, fact.value) for fact in pilot.menu.facts]
    pilot.tap("back")
    assert pilot.menu.name == "test"
    pilot.tap_until("menu", "controls")


def test_hostile_settings_files_are_reported_and_the_defaults_used(loop, outside):
    folder = outside.services.config
    folder.mkdir()
    (folder / BINDINGS_FILE).write_text(json.dumps({"formatVersion": 1, "keyboard": {"touch": []}}))
    (folder / "preferences.json").write_text("[" * 100_000)
    running = RunningPresenter(loop, outside.services, has_gamepad=False)
    running.advance(0.01)
    warnings = [message.text for message in running.presenter.screen.warnings]
    assert len(warnings) == 2
    assert all(text.endswith("The defaults are used.") for text in warnings)
    assert running.presenter.controls.bindings == DEFAULT_BINDINGS
    running.close()


def open_the_bindings(trainee):
    trainee.choose("controls", "controls")
    trainee.choose("rebind", "bindings")
