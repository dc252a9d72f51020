"""An instructor's PIN locks settings, order and passing on the control at a seat."""

from __future__ import annotations

import re

import pytest

from rastrainer_simulator.flow.session.preferences import OF_TRAINEES
from rastrainer_simulator.presentation.messages import Hello

PIN = "402817"
OTHER = "402818"
PAGE = 7


@pytest.fixture(autouse=True)
def _pin(outside):
    outside.pin.set(PIN)


def open_pin(trainee):
    """Go from the start menu to the page where the PIN is entered."""
    trainee.until_menu("start")
    trainee.choose("settings", "settings")
    trainee.choose("unlock", "pin")


def enter(trainee, digits):
    trainee.hands.type(digits)
    trainee.tap("accept")


def until_unlocked(trainee):
    lock = trainee.presenter._session.lock
    trainee.until(lambda: not lock.is_locked, "the lock open")
    trainee.until_menu("settings")


def said(trainee):
    return [warning.text for warning in trainee.presenter.screen.warnings]


def until_message(trainee, sentence):
    trainee.until(lambda: any(sentence in text for text in said(trainee)), sentence)


def enabled(trainee):
    return {item.name for item in trainee.menu.items if item.is_enabled}


def test_with_a_pin_set_only_language_and_sound_can_be_changed_without_it(trainee):
    trainee.choose("settings", "settings")
    assert enabled(trainee) == {*OF_TRAINEES, "unlock", "back"}
    before = trainee.presenter._session.preferences
    trainee.focus("coarse")
    trainee.tap("right", "accept")
    assert trainee.presenter._session.preferences == before
    assert trainee.item("coarse").help == "Locked: an instructor enters the PIN below."


def test_after_the_pin_is_typed_the_order_can_be_chosen_and_locked_again(trainee):
    open_pin(trainee)
    trainee.hands.type("77")
    for _ in range(2):
        trainee.hands.key("Backspace")
    trainee.hands.type(PIN[:3])
    for digit in PIN[3:]:
        trainee.hands.key(f"Numpad{digit}", digit)
    trainee.tap("accept")
    until_unlocked(trainee)
    assert {"order", "tutorial", "coarse"} <= enabled(trainee)
    trainee.focus("order")
    trainee.tap("right")
    assert trainee.presenter._session.preferences.order == "any"
    trainee.choose("lock")
    trainee.until(lambda: "order" not in enabled(trainee), "the items are locked")


def test_a_wrong_pin_unlocks_nothing_and_after_five_no_pin_is_checked(trainee, outside):
    # The boards and the seat share the limit.
    assert not outside.services.pin.guess(OTHER).is_right
    open_pin(trainee)
    enter(trainee, "4028")
    assert trainee.item("unlock").help == "A PIN has 6 to 12 digits."
    for number in range(1, 5):
        enter(trainee, "18" if number == 1 else OTHER)
        until_message(trainee, "wait 1 s" if number == 4 else "not the PIN of this seat")
        trainee.until(lambda: trainee.item("unlock").value == "_", "the digits are cleared")
        trainee.presenter.advance(6.0)
    enter(trainee, PIN)
    until_message(trainee, "wait 1 s")
    assert outside.services.pin.guess(PIN).wait_s == 1.0
    assert trainee.presenter._session.lock.is_locked
    outside.now = 1.5
    enter(trainee, PIN)
    until_unlocked(trainee)


def unlock(trainee):
    open_pin(trainee)
    enter(trainee, PIN)
    until_unlocked(trainee)


def unlock_in_the_trials_menu(trainee):
    """Open the menu of the trial, and enter the PIN in its settings."""
    trainee.tap_until("menu", "trial")
    trainee.choose("settings", "settings")
    trainee.choose("unlock", "pin")
    enter(trainee, PIN)
    until_unlocked(trainee)


def test_the_settings_lock_again_when_a_trial_begins_and_stay_locked_in_its_menu(trainee):
    trainee.presenter._session.trainee = "P07"
    trainee.step(2)
    unlock(trainee)
    trainee.start("task-1")
    assert trainee.presenter._session.lock.is_locked
    unlock_in_the_trials_menu(trainee)
    assert "order" in enabled(trainee)
    assert trainee.item("coarse").help == "This cannot be changed until the trial has ended."
    assert trainee.submit("Abort").ok
    trainee.until_menu("experiment")
    assert not trainee.presenter._session.lock.is_locked


def press_menu(presenter):
    presenter.on_key(PAGE, "KeyM", True, "m")
    presenter.on_key(PAGE, "KeyM", False, "")


def test_another_view_takes_control_from_an_idle_operator_only_with_the_pin(trainee, presenter):
    trainee.start("task-1")
    trainee.hands.push(1.0, 0.0, 0.0, False)
    trainee.step(2)
    trainee.hands.push(0.0, 0.0, 0.0, False)
    presenter.view_joined(PAGE, Hello("page"))
    presenter.advance(31.0)
    press_menu(presenter)
    trainee.step(2)
    assert presenter.control.view == 1
    until_message(trainee, "Only an instructor can pass it on: Menu, Settings, Instructor's PIN.")
    unlock_in_the_trials_menu(trainee)
    presenter.advance(31.0)
    press_menu(presenter)
    trainee.step(2)
    assert presenter.control.view == PAGE


def test_no_screen_file_or_event_contains_the_pin(trainee, outside):
    open_pin(trainee)
    trainee.hands.type(PIN)
    assert trainee.item("unlock").value == "••••••_"
    trainee.tap("accept")
    until_unlocked(trainee)
    trainee.focus("volume")
    trainee.tap("right")
    watcher = trainee.watcher
    assert PIN not in repr((watcher.screens, watcher.feedbacks, watcher.controls))
    shown = [screen for screen in watcher.screens if screen.menu is not None]
    typed = [screen for screen in shown if screen.menu.name == "pin"]
    assert typed
    assert all(screen.is_private for screen in typed)
    # While it is typed, the focus stays where it unlocks, and only dots come.
    focuses = {screen.menu.focus for screen in typed if re.search("•", str(screen.menu.items))}
    assert focuses == {"unlock"}
    folder = outside.services.config.parent
    written = [path for path in folder.rglob("*") if path.is_file()]
    assert written
    assert not [path for path in written if PIN.encode() in path.read_bytes()]
