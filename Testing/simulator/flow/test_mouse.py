"""The flow by the mouse alone: menus, hints and sticks that are dragged."""

from __future__ import annotations

import pytest

from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from Testing.simulator.flow.trainee import VIEW, ClickingTrainee, Mouse


@pytest.fixture
def clicking(loop, presenter):
    trainee = ClickingTrainee(loop, presenter, lambda it: Mouse(it, "page"))
    trainee.until_menu("start")
    yield trainee
    trainee.close()


def test_an_id_is_clicked_character_by_character_and_a_known_one_at_once(clicking, outside):
    clicking.start("task-1", "P21")
    clicking.submit("Abort")
    clicking.until_menu("experiment")
    session = clicking.presenter._session
    session.history, session.trainee = TraineeHistory(outside.services.records), ""
    clicking.choose("mode")
    clicking.choose("clicked")
    for item in ("row 1", "P", "row 0", "A", "delete", "row 3", "7"):
        clicking.hands.click(item)
    assert clicking.menu.facts[0].value == "P7_"
    clicking.hands.click("done")
    assert clicking.item("trainee").value == "P7"
    clicking.hands.click("clicked")
    clicking.hands.click("known P21")
    assert clicking.item("trainee").value == "P21"


def test_the_arm_is_driven_and_touches_are_made_and_undone_by_clicks_and_dragged_sticks(clicking):
    session = clicking.presenter._session
    session.prefer(order="any")
    session.trainee = "P07"
    clicking.open_experiment()
    clicking.hands.click("trial-run")
    clicking.until_menu(None)
    assert not clicking.presenter.screen.has_sticks
    clicking.hands.click("press sticks")
    clicking.touch_point("1")
    assert clicking.touched == 1
    assert clicking.presenter.control.holder == "mouse"
    controls = {hint.control for hint in clicking.presenter.screen.hints}
    assert {"Left stick", "Right stick up / down", "Touch", "Undo", "Slow", "Menu"} <= controls
    clicking.tap("undo")
    clicking.until(lambda: clicking.touched == 0, "the undo")
    clicking.tap_until("menu", "trial")
    clicking.hands.click("resume")
    clicking.until_menu(None)
    clicking.hands.click("press sticks")
    assert not clicking.presenter.screen.has_sticks


def test_the_right_stick_tilts_once_its_hint_has_been_clicked(clicking):
    clicking.hands.click("train")
    session, presenter = clicking.presenter._session, clicking.presenter
    session.operator.screen_sticks.is_shown = True
    for translation, rotation in (((0.0, 0.0, 0.5), (0.2, 0.0)), ((0.0, 0.0, 0.0), (0.2, 0.5))):
        presenter.on_sticks(VIEW, (0.0, 0.0, 0.5), (0.2, 0.0), False, 0.0)
        held = session.controls.held
        assert (held.translation, held.rotation) == (translation, rotation)
        presenter.on_item(VIEW, "press tilt")
