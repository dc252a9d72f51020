"""By the mouse alone: menus, the ID, the sticks on the screen, touches, undo and the menu."""

from __future__ import annotations

from dataclasses import replace

import pytest

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.flow.session.trainee_history import DoneTasks
from rastrainer_simulator.input.inputs import ControlName
from Testing.simulator.flow.mouse import VIEW, Mouse
from Testing.simulator.flow.trainee import Trainee


@pytest.fixture(params=["desktop", "page"])
def clicking(loop, presenter, request):
    trainee = Trainee(loop, presenter, lambda it: Mouse(it, request.param))
    trainee.until_menu("start")
    yield trainee
    trainee.close()


def go_to_experiment(clicking):
    for menu, item in (
        ("start", "train"),
        ("introduction", "skip"),
        ("controls", "next"),
    ):
        clicking.until_menu(menu)
        clicking.hands.click(item)
    clicking.until_menu("experiment")


def test_a_new_id_is_clicked_character_by_character(clicking):
    go_to_experiment(clicking)
    for item in ("clicked", "row 1", "P", "row 0", "A", "delete", "row 3", "7"):
        clicking.hands.click(item)
    assert clicking.menu.facts[0].value == "P7_"
    clicking.hands.click("done")
    assert clicking.item("trainee").value == "P7"


def test_an_id_that_has_trained_here_is_one_click_away(clicking, outside):
    clicking.start("task-1", "P21")
    clicking.submit("Abort")
    clicking.until_menu("experiment")
    clicking.presenter._session.progress = DoneTasks(outside.services.records)
    clicking.hands.click("mode")
    clicking.hands.click("clicked")
    clicking.hands.click("known P21")
    assert clicking.item("trainee").value == "P21"


def test_the_arm_is_driven_touches_and_takes_back_by_clicks_and_dragged_sticks(clicking):
    session = clicking.presenter._session
    session.prefer(replace(session.preferences, order="any"))
    session.trainee = "P07"
    go_to_experiment(clicking)
    clicking.hands.click("trial-run")
    clicking.until_menu(None)
    assert not clicking.presenter.screen.has_sticks
    clicking.hands.click("press sticks")
    truth = clicking.loop.truth
    center = truth.in_world(truth.target) / MM_PER_M
    clicking.touch(truth.in_world(truth.fiducials["1"]) / MM_PER_M, center)
    assert clicking.touched == 1
    assert clicking.presenter.control.holder == "mouse"
    controls = {hint.control for hint in clicking.presenter.screen.hints}
    assert {"Left stick", "Right stick up / down", "Touch", "Undo", "Slow", "Menu"} <= controls
    clicking.tap("undo")
    clicking.until(lambda: clicking.touched == 0, "the undo")
    clicking.tap("menu")
    clicking.until_menu("trial")
    clicking.hands.click("resume")
    clicking.until_menu(None)
    clicking.hands.click("press sticks")
    assert not clicking.presenter.screen.has_sticks


def test_the_right_stick_tilts_once_its_hint_was_clicked(clicking):
    clicking.hands.click("train")
    session, presenter = clicking.presenter._session, clicking.presenter
    session.screen_sticks.is_shown = True
    presenter.on_sticks(VIEW, (0.0, 0.0, 0.5), (0.2, 0.0), False, 0.0)
    assert (session.held.translation, session.held.rotation) == ((0.0, 0.0, 0.5), (0.2, 0.0))
    presenter.on_item(VIEW, "press tilt")
    presenter.on_sticks(VIEW, (0.0, 0.0, 0.5), (0.2, 0.0), False, 0.0)
    assert (session.held.translation, session.held.rotation) == ((0.0, 0.0, 0.0), (0.2, 0.5))


def test_who_holds_a_gamepad_is_not_shown_what_is_for_a_mouse(pilot):
    pilot.start("task-1")
    pilot.hands.push(0.0, 0.0, 0.5, False)
    pilot.step(5)
    items = [hint.item for hint in pilot.presenter.screen.hints]
    assert "press sticks" not in items
    assert f"press {ControlName.TOUCH.value}" in items
