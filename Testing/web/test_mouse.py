"""The page by the mouse alone: the ID, the trial run, the sticks, touches, undo, menus."""

from __future__ import annotations

import numpy as np
import pytest

from Testing.web.chromium import open_page
from Testing.web.hands import PageMouse
from Testing.web.place import WITHOUT_GRAPHICS, Place, Trainee

SIZE = {"width": 1280, "height": 720}
SLOW = "0.5"
"""Simulated seconds in a second, so that a stick is let go of in time on a busy machine."""
ON_SCREEN = {"order": "fixed"}


class Clicks:
    """Menus by clicks, as far as an ID and the task."""

    def choose(self, item: str) -> None:
        """Click on an item, which leads to another menu."""
        before = self.menu.name
        self.hands.click(item)
        self.until(lambda: not self.menu or self.menu.name != before, f"after {item}")

    def click_id(self) -> None:
        """Enter the ID P7, a character at a time."""
        self.choose("clicked")
        for row, character in (("row 1", "P"), ("row 3", "7")):
            self.choose(row)
            self.choose(character)
        self.choose("done")
        assert self.value("trainee") == "P7"

    def begin_trial_run(self) -> None:
        """Go from the start menu to the trial run with the sticks on the screen."""
        for item in ("train", "skip", "next"):
            self.choose(item)
        self.click_id()
        self.begin_task("trial-run")
        self.hands.click("press sticks")
        self.until(lambda: self.view.screen.has_sticks, "the sticks")


class ClickingTrainee(Clicks, Trainee):
    """Does everything by the mouse."""


@pytest.fixture
def place(tmp_path):
    with Place(tmp_path, "--speed", SLOW, limits=WITHOUT_GRAPHICS, **ON_SCREEN) as place:
        yield place


@pytest.fixture
def page(place, browser):
    simulator = place.simulator
    page = open_page(browser, simulator.url, simulator.code, size=SIZE, draws=False)
    yield page
    assert page.problems == []


def test_a_mouse_enters_an_id_drives_the_arm_and_opens_the_menu(place, page):
    trainee = ClickingTrainee(place.view, PageMouse(page))
    trainee.begin_trial_run()
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


@pytest.mark.soak
def test_the_first_touches_of_the_trial_run_are_steered_by_the_mouse(place, page):
    trainee = ClickingTrainee(place.view, PageMouse(page))
    trainee.begin_trial_run()
    for label in ("1", "2"):
        trainee.touch(label)
    assert trainee.touched == 2
    assert {entry["operator"] for entry in place.entries("input")} <= {"mouse", ""}
