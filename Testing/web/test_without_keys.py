"""Without keys: by the mouse, two thumbs or a tracked hand alone, from the menus to the touches."""

from __future__ import annotations

from contextlib import contextmanager

import numpy as np
import pytest

from rastrainer_simulator.flow.session.chosen_trial import FIRST_ID
from rastrainer_simulator.flow.tutorial.steps import steps_for
from rastrainer_simulator.input.inputs import SourceKind
from Testing.end_to_end.stream_trainee import LONGEST_WAY_S
from Testing.end_to_end.view_learner import ViewLearner
from Testing.tutorial_player import TutorialPlayer
from Testing.web.chromium import enter_headset, open_page
from Testing.web.hands import PageMouse, TrackedHands
from Testing.web.place import OnPage, Place, Trainee
from Testing.web.tapping_trainee import PHONE, SteeringTrainee, TappingTrainee

SIZE = {"width": 1280, "height": 720}
SLOW, SLOWEST = "0.5", "0.25"
"""Simulated seconds per second, so that a stick is released in time on a busy machine."""


class ClickingTrainee(OnPage, Trainee):
    """Does everything by the mouse."""

    def __init__(self, view, page):
        super().__init__(view, PageMouse(page))
        self.page = page

    def choose_on_page(self, item):
        self.hands.click(item)

    def click_id(self) -> None:
        """Add P7 to the ID, a character at a time."""
        before = self.value("trainee").removeprefix(FIRST_ID)
        self.choose("clicked")
        for row, character in (("row 1", "P"), ("row 3", "7")):
            self.choose(row)
            self.choose(character)
        self.choose("done")
        assert self.value("trainee") == f"{before}P7"

    def begin_by_sticks(self, task: str) -> None:
        """Go to a task, or the tutorial, with sticks on the screen."""
        self.go_to_experiment()
        self.click_id()
        self.choose(task)
        self.until_menu(None)
        shown = "trial-run" if task == "tutorial" else task
        self.until(lambda: self.view.scene["task"] == shown, "the scene")
        if not self.view.screen.has_sticks:
            self.hands.click("press sticks")
        self.until(lambda: self.view.screen.has_sticks, "the sticks")


class HandTrainee(OnPage, Trainee):
    """Pinches at the panels' buttons; elsewhere the tip follows the pinching hand."""

    def __init__(self, view, page):
        super().__init__(view, TrackedHands(page))
        self.page = page

    def choose_on_page(self, item):
        self.hands.choose(item)

    def steer_to(self, place, near, fine=False):  # noqa: ARG002
        if self.menu_name == "trial":
            self.choose("resume")
        self._lead(place, lambda: np.linalg.norm(place - self.tip) <= near)

    def sink_onto_skin(self, below):
        self._lead(below, lambda: self.view.state["proximity"] == "contact")

    def _lead(self, place, is_there):
        self.hands.pinch(True)
        self.hands.carry(place - self.tip)
        give_up = self.view.state["timeS"] + LONGEST_WAY_S
        while not is_there() and self.view.state["timeS"] < give_up:
            self.view.next_state()
        self.hands.pinch(False)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("without-keys")
    with Place(folder, "--speed", SLOW, order="any") as place:
        yield place


@contextmanager
def page_of(place, browser, *headset, **options):
    """A page of that place, which leaves the arm to the next one even if a test has failed."""
    simulator = place.simulator
    page = open_page(browser, simulator.url, simulator.code, *headset, draws=False, **options)
    with page.context:
        yield page
        assert page.problems == []


@pytest.fixture
def thumbs(place, browser):
    """A trainee whose trial is running, begun by tapping, and the page."""
    with page_of(place, browser, size=PHONE, has_touch=True) as page:
        trainee = TappingTrainee(place, page)
        trainee.begin_by_taps("task-1")
        page.wait_for_selector("#touch-controls")
        yield trainee, page
        trainee.press("menu", lambda: trainee.menu is not None, "the menu")
        trainee.choose("abort")
        trainee.choose("abort")


@pytest.fixture
def mouse(place, browser):
    with page_of(place, browser, size=SIZE) as page:
        trainee = ClickingTrainee(place.view, page)
        yield trainee, page
        trainee.go_home()


@contextmanager
def hand_in_task_1(place, browser):
    """A trainee in Task 1, begun by a tracked hand."""
    with page_of(place, browser, "metaQuest3") as page:
        enter_headset(page)
        trainee = HandTrainee(place.view, page)
        begin(trainee)
        yield trainee


@pytest.mark.soak
def test_a_finger_touches_undoes_pauses_and_resumes(place, thumbs):
    steering, page = thumbs
    steering.touch("1")
    assert steering.touched == 1
    page.wait_for_selector("#control:has-text('You drive: touch screen')")
    steering.press("undo", lambda: steering.touched == 0, "the undo")
    steering.press("menu", lambda: steering.menu is not None, "the menu")
    steering.until(lambda: place.view.state["phase"] == "paused", "the pause")
    page.wait_for_selector("#touch-controls", state="hidden")
    steering.resume()


def test_two_thumbs_steer_together_and_stop_the_arm_and_the_buttons_show_the_hints(place, thumbs):
    steering, page = thumbs
    steering.until_still()
    start = steering.tip.copy()
    steering.hands.push(0.7, 0.0, 1.0)
    steering.until(lambda: steering.tip[2] > start[2] + 0.02, "a move up")
    aside = np.linalg.norm((steering.tip - start)[:2])
    steering.hands.push(0.0, 0.0, 0.0)
    assert aside > 0.005
    steering.until_still()
    buttons = page.locator("#touch-controls button:not([hidden])")

    def are_written():
        hints = {hint.control for hint in place.view.screen.hints if "stick" not in hint.control}
        return hints == {*buttons.all_inner_texts()}

    steering.until(are_written, "the hints on the buttons")


@pytest.mark.soak
def test_a_whole_trial_is_touched_and_scored_with_two_thumbs_alone(tmp_path, browser):
    slow = Place(tmp_path, "--speed", SLOW, order="any")
    with slow as place, page_of(place, browser, size=PHONE, has_touch=True) as page:
        trainee = SteeringTrainee(place, page)
        trainee.begin_by_taps("task-1")
        page.wait_for_selector("#touch-controls .stick")
        trainee.play_to_result()
        assert len(place.entries("touch")) == 15
        assert {entry["operator"] for entry in place.entries("input")} <= {"touch screen", ""}


def test_a_mouse_enters_an_id_drives_the_arm_and_opens_the_menu(mouse):
    trainee, page = mouse
    trainee.begin_by_sticks("task-1")
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
    trainee.choose("resume")
    assert np.isfinite(trainee.tip).all()


class MouseLearner(ViewLearner):
    """Drags with the right button."""

    def turn_view(self):
        self.hands.turn_view(200)


@pytest.mark.soak
def test_the_tutorial_is_done_with_the_mouse_alone_and_leads_to_the_trial_run(tmp_path, browser):
    rules = {"order": "fixed", "tutorial": "required"}
    slowest = Place(tmp_path, "--speed", SLOWEST, **rules)
    with slowest as place, page_of(place, browser, size=SIZE) as page:
        trainee = ClickingTrainee(place.view, page)
        trainee.begin_by_sticks("tutorial")
        player = TutorialPlayer(MouseLearner(trainee), SourceKind.MOUSE)
        player.play()
        assert [step for step, _text in player.read] == list(steps_for(SourceKind.MOUSE, "desktop"))
        trainee.until_menu("tutorial-done")
        trainee.begin_task("trial-run")
        page.wait_for_selector("#touch-controls .stick")


@pytest.mark.soak
def test_the_first_touches_of_a_task_are_steered_by_the_mouse(place, mouse):
    trainee, _page = mouse
    trainee.begin_by_sticks("task-1")
    for label in ("1", "2"):
        trainee.touch(label)
    assert trainee.touched == 2
    assert {entry["operator"] for entry in place.entries("input")} <= {"mouse", ""}


@pytest.mark.soak
def test_a_whole_trial_is_touched_and_scored_with_the_mouse_alone(tmp_path, browser):
    slow = Place(tmp_path, "--speed", SLOW, order="any")
    with slow as place, page_of(place, browser, size=SIZE) as page:
        trainee = ClickingTrainee(place.view, page)
        trainee.begin_by_sticks("task-1")
        trainee.play_to_result()
        assert len(place.entries("touch")) == 15
        assert {entry["operator"] for entry in place.entries("input")} <= {"mouse", ""}


def begin(trainee):
    """Go by the hand from the start menu into Task 1."""
    trainee.go_to_experiment()
    trainee.choose("trainee")
    trainee.hands.choose("row0")
    trainee.until(lambda: "A" in trainee.menu.facts[0].value, "the letter A")
    trainee.choose("done")
    trainee.begin_task("task-1")


def test_a_tracked_hand_moves_the_tip_to_a_touch_undoes_it_and_opens_the_menu(place, browser):
    with hand_in_task_1(place, browser) as hand:
        hand.touch("1")
        hand.press("undo", lambda: hand.touched == 0, "the undo")
        hand.press("menu", lambda: hand.menu is not None, "the menu")
        hand.choose("abort")
    inputs = place.entries("input")
    assert {entry["operator"] for entry in inputs} <= {"headset's controllers", ""}


@pytest.mark.soak
def test_a_whole_trial_is_touched_and_scored_with_a_tracked_hand_alone(tmp_path, browser):
    slow = Place(tmp_path, "--speed", SLOW, order="any")
    with slow as place, hand_in_task_1(place, browser) as hand:
        hand.play_to_result()
        assert len(place.entries("touch")) == 15
