"""A phone without keys: menus are tapped, two thumbs steer, and a trial is done."""

from __future__ import annotations

import numpy as np
import pytest

from Testing.web.chromium import open_page
from Testing.web.place import PATIENT, Place
from Testing.web.tapping_trainee import PHONE, SteeringTrainee, TappingTrainee
from Testing.web.test_mouse import SLOW


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    with Place(tmp_path_factory.mktemp("phone"), limits=PATIENT) as place:
        yield place


@pytest.fixture(scope="module")
def trainee(place, page):
    return TappingTrainee(place, page)


@pytest.fixture(scope="module")
def page(place, browser):
    page = open_page(
        browser, place.simulator.url, place.simulator.code, size=PHONE, has_touch=True, draws=False
    )
    yield page
    assert page.problems == []


@pytest.fixture
def steering(place, page, trainee):
    """Somebody whose trial runs, begun by tapping."""
    if place.view.state["phase"] != "running":
        trainee.begin_by_taps("task-1")
    page.wait_for_selector("#touch-controls")
    return trainee


@pytest.mark.soak
def test_a_finger_touches_undoes_pauses_and_resumes(place, page, steering):
    steering.touch("1")
    assert steering.touched == 1
    page.wait_for_selector("#control:has-text('You drive: touch screen')")
    steering.press("undo", lambda: steering.touched == 0, "the undo")
    steering.press("menu", lambda: steering.menu is not None, "the menu")
    steering.until(lambda: place.view.state["phase"] == "paused", "the pause")
    page.wait_for_selector("#touch-controls", state="hidden")
    steering.resume()


def test_two_thumbs_steer_at_once_and_the_arm_stops_when_they_are_lifted(steering):
    steering.until_still()
    start = steering.tip.copy()
    steering.hands.push(0.7, 0.0, 1.0)
    steering.until(lambda: steering.tip[2] > start[2] + 0.02, "a move up")
    aside = np.linalg.norm((steering.tip - start)[:2])
    steering.hands.push(0.0, 0.0, 0.0)
    assert aside > 0.005
    steering.until_still()


def test_what_is_said_to_press_is_written_on_the_buttons(place, page, steering):
    steering.hands.push(0.0, 0.0, 0.5)
    steering.until_moved()
    steering.hands.push(0.0, 0.0, 0.0)
    buttons = page.locator("#touch-controls button:not([hidden])")

    def are_written():
        hints = {hint.control for hint in place.view.screen.hints if "stick" not in hint.control}
        return hints == {*buttons.all_inner_texts()}

    steering.until(are_written, "the hints on the buttons")


@pytest.mark.soak
def test_by_two_thumbs_alone_a_whole_trial_is_touched_and_scored(tmp_path, browser):
    with Place(tmp_path, "--speed", SLOW, limits=PATIENT, order="any") as place:
        simulator = place.simulator
        page = open_page(
            browser, simulator.url, simulator.code, size=PHONE, has_touch=True, draws=False
        )
        trainee = SteeringTrainee(place, page)
        trainee.begin_by_taps("task-1")
        page.wait_for_selector("#touch-controls .stick")
        trainee.play_to_result()
        assert len(place.entries("touch")) == 15
        assert {entry["operator"] for entry in place.entries("input")} <= {"touch screen", ""}
        assert page.problems == []
