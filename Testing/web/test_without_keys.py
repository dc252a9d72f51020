"""Without keys: by the mouse, two thumbs or a tracked hand alone, from the menus to the touches.

Whole trials are in test_whole_flow.py, whole drills in test_whole_drill.py.
"""

from __future__ import annotations

from contextlib import contextmanager

import numpy as np
import pytest

from Testing.end_to_end.lab import Place
from Testing.web.chromium import enter_headset, open_page
from Testing.web.trainees_on_page import (
    DESKTOP,
    PHONE,
    ClickingTrainee,
    HandTrainee,
    TappingTrainee,
)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """At half the speed, a stick is released in time on a busy machine."""
    with Place(tmp_path_factory.mktemp("without-keys"), "--speed", "0.5") as place:
        yield place


@contextmanager
def page_of(place, browser, *headset, **options):
    """A page of that place, which leaves the arm to the next one even if a test has failed."""
    options |= {"draws": False, "has_scene": bool(headset)}
    page = open_page(browser, place.url, place.code, *headset, **options)
    with page.context:
        yield page
        assert page.problems == []


def test_two_thumbs_touch_undo_pause_steer_together_stop_the_arm_and_turn_the_view(place, browser):
    with page_of(place, browser, size=PHONE, has_touch=True) as page:
        trainee = TappingTrainee(place, page)
        trainee.begin("task-1")
        page.wait_for_selector("#touch-controls")
        trainee.touch("1")
        page.wait_for_selector("#control:has-text('You drive: touch screen')")
        trainee.press("undo", lambda: trainee.touched == 0, "the undo")
        trainee.press("menu", lambda: trainee.menu is not None, "the menu")
        page.wait_for_selector("#touch-controls", state="hidden")
        trainee.resume()
        page.wait_for_selector("#touch-controls")
        trainee.until_still()
        start = trainee.tip.copy()
        trainee.hands.push(0.7, 0.0, 1.0)
        trainee.until(lambda: trainee.tip[2] > start[2] + 0.02, "a move up")
        aside = np.linalg.norm((trainee.tip - start)[:2])
        trainee.hands.push(0.0, 0.0, 0.0)
        assert aside > 0.005
        trainee.until_still()
        buttons = page.locator("#touch-controls button:not([hidden])")

        def are_written():
            hints = {hint.control for hint in place.view.screen.hints}
            return {hint for hint in hints if "stick" not in hint} == {*buttons.all_inner_texts()}

        trainee.until(are_written, "the hints on the buttons")
        before = place.view.state["view"]
        drag_a_finger(page)
        trainee.until(lambda: place.view.state["view"] != before, "another view")
        trainee.press("menu", lambda: trainee.menu is not None, "the menu")
        trainee.go_home()


def drag_a_finger(page):
    """Drag a finger over the picture."""
    send = page.context.new_cdp_session(page).send
    for kind, x in (("touchStart", 60), ("touchMove", 200), ("touchMove", 330)):
        points = [{"id": 7, "x": x, "y": 300}]
        send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


def test_a_mouse_enters_an_id_drives_the_arm_and_opens_the_menu(place, browser):
    with page_of(place, browser, size=DESKTOP) as page:
        trainee = ClickingTrainee(place, page)
        trainee.go_to_experiment()
        trainee.type_id()
        trainee.begin_task("task-1")
        page.wait_for_selector("#touch-controls .stick")
        assert page.query_selector("#touch-controls button:visible") is None
        start = trainee.tip.copy()
        # Gently: a busy machine releases late, and the arm must not be far away then.
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
        trainee.go_home()


def test_a_tracked_hand_touches_undoes_it_and_opens_the_menu(place, browser):
    with page_of(place, browser, "metaQuest3") as page:
        enter_headset(page)
        hand = HandTrainee(place, page)
        hand.begin("task-1")
        hand.touch("1")
        hand.press("undo", lambda: hand.touched == 0, "the undo")
        hand.press("menu", lambda: hand.menu is not None, "the menu")
        hand.choose("abort")
    assert place.operators == {"headset's controllers"}
