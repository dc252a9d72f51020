"""A trial in the emulated headset by a tracked hand alone: menus, touches, undo and the result."""

from __future__ import annotations

import numpy as np
import pytest

from Testing.end_to_end.stream_trainee import LONGEST_WAY_S
from Testing.web.chromium import enter_headset, open_page
from Testing.web.hands import TrackedHands
from Testing.web.place import PATIENT, Place, Trainee

SPEED = "0.5"


class HandTrainee(Trainee):
    """Pinches at what is written on boards; elsewhere the tip follows the pinching hand."""

    def __init__(self, view, page):
        super().__init__(view, TrackedHands(page))
        self._page = page

    def choose(self, item):
        before = self.menu_name
        # Else the board of the menu before, which may have an item of that name elsewhere.
        self._page.wait_for_selector(f"body[data-menu='{before or ''}']", state="attached")
        self.hands.choose(item)
        self.until(lambda: self.menu_name != before, f"after {item}")

    def steer_to(self, place, near, fine=False):  # noqa: ARG002
        if self.menu_name == "trial":
            self.choose("resume")
        self._lead(place, lambda: np.linalg.norm(place - self.tip) <= near)

    def sink_onto_skin(self, below):
        self._lead(below, lambda: self.view.state["proximity"] == "contact")

    def _lead(self, place, is_there):
        self.hands.pinch(True)
        self.hands.carry(place - self.tip)
        give_up = self.view.state["time"] + LONGEST_WAY_S
        while not is_there() and self.view.state["time"] < give_up:
            self.view.next_state()
        self.hands.pinch(False)


@pytest.fixture
def place(tmp_path):
    with Place(tmp_path, "--speed", SPEED, limits=PATIENT) as place:
        yield place


@pytest.fixture
def trainee(place, browser):
    simulator = place.simulator
    page = open_page(browser, simulator.url, simulator.code, "metaQuest3", draws=False)
    enter_headset(page)
    yield HandTrainee(place.view, page)
    assert page.problems == []


def begin(trainee):
    """Go by the hand from the start menu into Task 1."""
    trainee.go_to_experiment()
    trainee.choose("trainee")
    trainee.hands.choose("row0")
    trainee.until(lambda: trainee.menu.facts[0].value.startswith("A"), "the letter A")
    trainee.choose("done")
    trainee.begin_task("task-1")


def test_a_tracked_hand_leads_the_tip_to_a_touch_takes_it_back_and_opens_the_menu(place, trainee):
    begin(trainee)
    trainee.touch("1")
    trainee.press("undo", lambda: trainee.touched == 0, "the undo")
    trainee.press("menu", lambda: trainee.menu is not None, "the menu")
    trainee.choose("abort")
    inputs = place.entries("input")
    assert {entry["operator"] for entry in inputs} <= {"headset's controllers", ""}


@pytest.mark.soak
def test_a_whole_trial_is_touched_and_scored_by_a_tracked_hand_alone(place, trainee):
    begin(trainee)
    trainee.play_to_result()
    assert len(place.entries("touch")) == 15
