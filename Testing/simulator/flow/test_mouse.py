"""The flow by the mouse alone: menus, hints and sticks that are dragged, up to a scored trial."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.journal.journal_file import read_journal
from rastrainer_simulator.flow.session.trainee_history import TraineeHistory
from rastrainer_simulator.flow.tutorial.steps import TutorialStep
from rastrainer_simulator.input.inputs import ControlName, SourceKind
from Testing.simulator.flow.learner import FlowLearner
from Testing.simulator.flow.mouse import VIEW, ClickingTrainee, Mouse
from Testing.simulator.flow.trainee import Trainee
from Testing.tutorial_player import TutorialPlayer


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


def test_a_previously_used_id_is_one_click_away(clicking, outside):
    clicking.start("task-1", "P21")
    clicking.submit("Abort")
    clicking.until_menu("experiment")
    clicking.presenter._session.history = TraineeHistory(outside.services.records)
    clicking.hands.click("mode")
    clicking.hands.click("clicked")
    clicking.hands.click("known P21")
    assert clicking.item("trainee").value == "P21"


def test_the_arm_is_driven_and_touches_are_made_and_undone_by_clicks_and_dragged_sticks(clicking):
    session = clicking.presenter._session
    session.prefer(order="any")
    session.trainee = "P07"
    go_to_experiment(clicking)
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
    session.screen_sticks.is_shown = True
    presenter.on_sticks(VIEW, (0.0, 0.0, 0.5), (0.2, 0.0), False, 0.0)
    held = session.controls.held
    assert (held.translation, held.rotation) == (
        (0.0, 0.0, 0.5),
        (0.2, 0.0),
    )
    presenter.on_item(VIEW, "press tilt")
    presenter.on_sticks(VIEW, (0.0, 0.0, 0.5), (0.2, 0.0), False, 0.0)
    held = session.controls.held
    assert (held.translation, held.rotation) == (
        (0.0, 0.0, 0.0),
        (0.2, 0.5),
    )


def test_a_trainee_with_a_gamepad_is_not_shown_mouse_controls(pilot):
    pilot.start("task-1")
    pilot.hands.push(0.0, 0.0, 0.5, False)
    pilot.step(5)
    items = [hint.item for hint in pilot.presenter.screen.hints]
    assert "press sticks" not in items
    assert f"press {ControlName.TOUCH.value}" in items


REGISTRATION = {"matrix": np.eye(4).ravel().tolist(), "freMm": 1.25, "expectedTreMm": 1.5}


class MouseLearner(FlowLearner):
    """Turns the view by dragging with the right button."""

    def turn_view(self):
        self.hands.turn_view(25.0)


@pytest.fixture(params=["desktop", "page"])
def newcomer(loop, outside, request):
    """A trainee with a mouse who has to do the tutorial, as at the first start."""
    presenter = outside.presenter(loop)
    trainee = ClickingTrainee(loop, presenter, lambda it: Mouse(it, request.param))
    trainee.until_menu("start")
    yield trainee
    trainee.close()
    presenter.close()


def enter_id(newcomer):
    for menu, item in (("start", "train"), ("introduction", "skip"), ("controls", "next")):
        newcomer.until_menu(menu)
        newcomer.choose(item)
    newcomer.until_menu("experiment")
    for item in ("clicked", "row 1", "P", "row 3", "7", "done"):
        newcomer.choose(item)
    assert newcomer.item("trainee").value == "P7"


def train_and_view_the_result(newcomer, outside, task):
    """Touch all points of a running task, register them and read the score."""
    newcomer.play(task)
    assert len(newcomer.state.training.touches) == 15
    trial_id = newcomer.register()
    outside.has_slicer = True
    assert newcomer.submit("SubmitRegistration", trialId=trial_id, **REGISTRATION).ok
    assert newcomer.submit("TrialScored", trialId=trial_id, score=81.0, details={}).ok
    newcomer.until_menu("result")
    assert newcomer.menu.facts[0].value == "81 / 100"
    (path,) = outside.services.records.glob(f"*{trial_id}.journal")
    operators = {entry["operator"] for entry in read_journal(path).of_kind("input")}
    assert "mouse" in operators
    assert operators <= {"mouse", ""}


@pytest.mark.soak
@pytest.mark.parametrize("newcomer", ["desktop"], indirect=True)
def test_the_tutorial_and_a_scored_trial_are_done_with_the_mouse_alone(newcomer, outside):
    enter_id(newcomer)
    assert not newcomer.item("trial-run").is_enabled
    newcomer.choose("tutorial", None)
    newcomer.hands.click("press sticks")
    player = TutorialPlayer(MouseLearner(newcomer), SourceKind.MOUSE)
    player.play()
    assert {step for step, _ in player.read} >= {TutorialStep.UNDO, TutorialStep.PAUSE}
    assert newcomer.menu.name == "tutorial-done"
    finished = TraineeHistory(outside.services.records).learned.get("P7")
    assert (finished.device, finished.mode) == ("mouse", "desktop")
    assert max(finished.errors_mm) < 3.0
    newcomer.choose("trial-run", None)
    train_and_view_the_result(newcomer, outside, "trial-run")


@pytest.mark.parametrize("newcomer", ["page"], indirect=True)
def test_an_optional_tutorial_is_skipped_and_a_trial_scored_with_the_mouse_alone(newcomer, outside):
    newcomer.presenter._session.prefer(tutorial="optional")
    enter_id(newcomer)
    newcomer.choose("tutorial", None)
    newcomer.tap_until("menu", "tutorial")
    newcomer.choose("leave", "experiment")
    newcomer.choose("trial-run", None)
    newcomer.hands.click("press sticks")
    train_and_view_the_result(newcomer, outside, "trial-run")
