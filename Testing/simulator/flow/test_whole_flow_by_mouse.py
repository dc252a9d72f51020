"""By the mouse alone from the ID over the tutorial, or past it, to a whole trial and its result."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.journal.journal_file import read_journal
from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.flow.session.preferences import Preferences
from rastrainer_simulator.flow.session.trainee_history import FinishedTutorials
from rastrainer_simulator.flow.tutorial.steps import TutorialStep
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.inputs import SourceKind
from Testing.simulator.flow.learner import FlowLearner
from Testing.simulator.flow.mouse import ClickingTrainee, Mouse
from Testing.tutorial_player import TutorialPlayer

REGISTRATION = {"matrix": np.eye(4).ravel().tolist(), "freMm": 1.25, "expectedTreMm": 1.5}


class MouseLearner(FlowLearner):
    """Turns the view by dragging with the right button."""

    def turn_view(self):
        self.hands.turn_view(25.0)


@pytest.fixture(params=["desktop", "page"])
def clicking(loop, outside, request):
    """A trainee with a mouse, whom the tutorial is asked of, as from the first start on."""
    presenter = FlowPresenter(loop, outside.services, DEFAULT_BINDINGS, Preferences())
    trainee = ClickingTrainee(loop, presenter, lambda it: Mouse(it, request.param))
    trainee.until_menu("start")
    yield trainee
    trainee.close()
    presenter.close()


def enter_id(clicking):
    for menu, item in (("start", "train"), ("introduction", "skip"), ("controls", "next")):
        clicking.until_menu(menu)
        clicking.choose(item)
    clicking.until_menu("experiment")
    for item in ("clicked", "row 1", "P", "row 3", "7", "done"):
        clicking.choose(item)
    assert clicking.item("trainee").value == "P7"


def train_and_look_at_the_result(clicking, outside, task):
    """Touch all points of a task that runs, register them and read the score."""
    clicking.play(task)
    assert len(clicking.state.training.touches) == 15
    trial_id = clicking.register()
    outside.has_slicer = True
    assert clicking.submit("SubmitRegistration", trialId=trial_id, **REGISTRATION).ok
    assert clicking.submit("TrialScored", trialId=trial_id, score=81.0, details={}).ok
    clicking.until_menu("result")
    assert clicking.menu.facts[0].value == "81 / 100"
    (path,) = outside.services.records.glob(f"*{trial_id}.journal")
    operators = {entry["operator"] for entry in read_journal(path).of_kind("input")}
    assert "mouse" in operators
    assert operators <= {"mouse", ""}


@pytest.mark.soak
@pytest.mark.parametrize("clicking", ["desktop"], indirect=True)
def test_by_the_mouse_the_tutorial_is_done_and_a_trial_is_touched_and_scored(clicking, outside):
    enter_id(clicking)
    assert not clicking.item("trial-run").is_enabled
    clicking.choose("tutorial")
    clicking.until_menu(None)
    clicking.hands.click("press sticks")
    player = TutorialPlayer(MouseLearner(clicking), SourceKind.MOUSE)
    player.play()
    assert {step for step, _ in player.read} >= {TutorialStep.UNDO, TutorialStep.PAUSE}
    assert clicking.menu.name == "tutorial-done"
    told = FinishedTutorials(outside.services.records).latest("P7")
    assert (told.device, told.mode) == ("mouse", "desktop")
    assert max(told.errors_mm) < 3.0
    clicking.choose("trial-run")
    clicking.until_menu(None)
    train_and_look_at_the_result(clicking, outside, "trial-run")


@pytest.mark.parametrize("clicking", ["page"], indirect=True)
def test_by_the_mouse_an_optional_tutorial_is_skipped_and_a_trial_is_touched_and_scored(
    clicking, outside
):
    clicking.presenter._session.prefer(Preferences(tutorial="optional"))
    enter_id(clicking)
    clicking.choose("tutorial")
    clicking.until_menu(None)
    clicking.tap("menu")
    clicking.until_menu("tutorial")
    clicking.choose("leave")
    clicking.until_menu("experiment")
    clicking.choose("trial-run")
    clicking.until_menu(None)
    clicking.hands.click("press sticks")
    train_and_look_at_the_result(clicking, outside, "trial-run")
