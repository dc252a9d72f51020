"""A phone without keys: menus are tapped, two thumbs steer, and a trial is done."""

from __future__ import annotations

import pytest

from Testing.web.chromium import open_page
from Testing.web.hands import Thumbs
from Testing.web.place import TRAINEE, WITHOUT_GRAPHICS, CarriedTrainee, Place

PHONE = {"width": 390, "height": 844}


class TappingTrainee(CarriedTrainee):
    """Taps the items of menus."""

    def __init__(self, place, page):
        super().__init__(place.view, Thumbs(page), place.client())
        self._page = page

    def choose(self, item: str) -> None:
        """Tap an item, once the page shows its menu."""
        before = self.menu.name
        self._until_shown()
        self._page.tap(f"#menu li[data-name='{item}'] button")
        self.until(lambda: not self.menu or self.menu.name != before, f"after {item}")

    def write_id(self) -> None:
        self._until_shown()
        self._page.tap("#menu li[data-name=trainee] input")
        self._page.keyboard.insert_text(TRAINEE)
        self.until(lambda: self.value("trainee") == TRAINEE, "the ID")

    def _until_shown(self) -> None:
        self._page.wait_for_selector(f'body[data-menu="{self.menu.name}"]')


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    with Place(tmp_path_factory.mktemp("phone"), limits=WITHOUT_GRAPHICS) as place:
        yield place


@pytest.fixture(scope="module")
def trainee(place, page):
    return TappingTrainee(place, page)


@pytest.fixture(scope="module")
def page(place, browser):
    page = open_page(browser, place.simulator.url, place.simulator.code, size=PHONE, has_touch=True)
    yield page
    assert page.problems == []


def test_a_finger_types_an_id_begins_a_trial_touches_undoes_pauses_and_resumes(
    place, page, trainee
):
    trainee.go_to_experiment()
    trainee.write_id()
    trainee.begin_task("task-1")
    trainee.until(lambda: place.view.state["phase"] == "running", "the trial")
    page.wait_for_selector("#touch-controls")
    trainee.touch("1")
    assert trainee.touched == 1
    page.wait_for_selector("#control:has-text('You drive: touch screen')")
    trainee.press("undo", lambda: trainee.touched == 0, "the undo")
    trainee.press("menu", lambda: trainee.menu is not None, "the menu")
    assert place.view.state["phase"] == "paused"
    page.wait_for_selector("#touch-controls", state="hidden")
    trainee.resume()
    page.wait_for_selector("#touch-controls")


def test_two_thumbs_steer_at_once_and_the_arm_stops_when_they_are_lifted(trainee):
    trainee.until_still()
    start = trainee.tip.copy()
    trainee.hands.push(0.7, 0.0, 1.0)
    trainee.until(lambda: trainee.tip[2] > start[2] + 0.02, "a move up")
    aside = abs(trainee._stick_axes()[0] @ (trainee.tip - start))
    trainee.hands.push(0.0, 0.0, 0.0)
    assert aside > 0.005
    trainee.until_still()


def test_what_is_said_to_press_is_written_on_the_buttons(place, page):
    hints = {hint.control for hint in place.view.screen.hints}
    buttons = page.query_selector_all("#touch-controls button")
    assert hints == {button.inner_text() for button in buttons}
