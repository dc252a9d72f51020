"""The page by the mouse alone: the ID, the tutorial, the sticks, touches and menus."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer_simulator.flow.tutorial.steps import steps_for
from rastrainer_simulator.input.inputs import SourceKind
from Testing.end_to_end.view_learner import ViewLearner
from Testing.tutorial_player import TutorialPlayer
from Testing.web.chromium import open_page
from Testing.web.hands import PageMouse
from Testing.web.place import PATIENT, Place, Trainee

SIZE = {"width": 1280, "height": 720}
SLOW, SLOWEST = "0.5", "0.25"
"""Simulated seconds in a second, so that a stick is let go of in time on a busy machine."""
ON_SCREEN = {"order": "fixed"}


class Clicks:
    """Menus by clicks, as far as an ID and the task."""

    def choose(self, item: str) -> None:
        """Click on an item, which leads to another menu."""
        before = self.menu_name
        self.hands.click(item)
        self.until(lambda: self.menu_name != before, f"after {item}")

    def click_id(self) -> None:
        """Enter the ID P7, a character at a time."""
        self.choose("clicked")
        for row, character in (("row 1", "P"), ("row 3", "7")):
            self.choose(row)
            self.choose(character)
        self.choose("done")
        assert self.value("trainee") == "P7"

    def begin_by_sticks(self, task: str) -> None:
        """Go from the start menu to a task, or the tutorial, with sticks on the screen."""
        for item in ("train", "skip", "next"):
            self.choose(item)
        self.click_id()
        self.choose(task)
        self.until_menu(None)
        shown = "trial-run" if task == "tutorial" else task
        self.until(lambda: self.view.scene["task"] == shown, "the scene")
        self.hands.click("press sticks")
        self.until(lambda: self.view.screen.has_sticks, "the sticks")


class ClickingTrainee(Clicks, Trainee):
    """Does everything by the mouse."""


@pytest.fixture
def place(tmp_path):
    with Place(tmp_path, "--speed", SLOW, limits=PATIENT, **ON_SCREEN) as place:
        yield place


@pytest.fixture
def page(place, browser):
    simulator = place.simulator
    page = open_page(browser, simulator.url, simulator.code, size=SIZE, draws=False)
    yield page
    assert page.problems == []


def test_a_mouse_enters_an_id_drives_the_arm_and_opens_the_menu(place, page):
    trainee = ClickingTrainee(place.view, PageMouse(page))
    trainee.begin_by_sticks("trial-run")
    page.wait_for_selector("#touch-controls .stick")
    assert page.query_selector("#touch-controls button:visible") is None
    start = trainee.tip.copy()
    # Gently: a busy machine lets go late, and the arm must not be far away then.
    trainee.hands.push(0.0, 0.0, 0.5)
    trainee.until(lambda: trainee.tip[2] > start[2] + 0.01, "a move up")
    trainee.hands.push(-0.5, 0.0, 0.0)
    trainee.until_moved()
    trainee.hands.push(0.0, 0.0, 0.0)
    trainee.until_still()
    page.wait_for_selector("#control:has-text('You drive: mouse')")
    trainee.press("menu", lambda: trainee.menu is not None, "the menu")
    assert trainee.menu.name == "trial"
    page.wait_for_selector("#touch-controls", state="hidden")
    trainee.choose("resume")
    assert np.isfinite(trainee.tip).all()


class MouseLearner(ViewLearner):
    """Drags with the right button."""

    def turn_view(self):
        self.hands.turn_view(200)


@pytest.mark.soak
def test_by_the_mouse_alone_the_tutorial_is_done_and_leads_to_the_trial_run(tmp_path, browser):
    rules = {"order": "fixed", "tutorial": "required"}
    with Place(tmp_path, "--speed", SLOWEST, limits=PATIENT, **rules) as place:
        simulator = place.simulator
        page = open_page(browser, simulator.url, simulator.code, size=SIZE, draws=False)
        trainee = ClickingTrainee(place.view, PageMouse(page))
        trainee.begin_by_sticks("tutorial")
        player = TutorialPlayer(MouseLearner(trainee), SourceKind.MOUSE)
        player.play()
        assert [step for step, _text in player.read] == list(steps_for(SourceKind.MOUSE, "desktop"))
        trainee.until_menu("tutorial-done")
        trainee.begin_task("trial-run")
        page.wait_for_selector("#touch-controls .stick")
        assert page.problems == []


@pytest.mark.soak
def test_the_first_touches_of_the_trial_run_are_steered_by_the_mouse(place, page):
    trainee = ClickingTrainee(place.view, PageMouse(page))
    trainee.begin_by_sticks("trial-run")
    for label in ("1", "2"):
        trainee.touch(label)
    assert trainee.touched == 2
    assert {entry["operator"] for entry in place.entries("input")} <= {"mouse", ""}


@pytest.mark.soak
def test_by_the_mouse_alone_a_whole_trial_is_touched_and_scored(tmp_path, browser):
    with Place(tmp_path, "--speed", SLOW, limits=PATIENT, order="any") as place:
        simulator = place.simulator
        page = open_page(browser, simulator.url, simulator.code, size=SIZE, draws=False)
        trainee = ClickingTrainee(place.view, PageMouse(page))
        trainee.begin_by_sticks("task-1")
        trainee.play_to_result()
        assert len(place.entries("touch")) == 15
        assert {entry["operator"] for entry in place.entries("input")} <= {"mouse", ""}
        assert page.problems == []
