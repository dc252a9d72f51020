"""The drill of decisions on the page and in the headset, with the cases of a real form."""

from __future__ import annotations

import pytest

from Testing.end_to_end.lab import Place
from Testing.web.chromium import enter_headset, open_page
from Testing.web.trainees_on_page import (
    DESKTOP,
    PHONE,
    ClickingTrainee,
    HandTrainee,
    OnPage,
    SteeringTrainee,
)


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    with Place(tmp_path_factory.mktemp("decisions")) as place:
        yield place


def until_case(trainee: OnPage, number: int) -> None:
    def is_shown() -> bool:
        menu = trainee.menu
        return menu is not None and menu.title.startswith(f"Case {number} ") and bool(menu.facts)

    trainee.until(is_shown, f"case {number}")


def play_case(trainee: OnPage, number: int) -> None:
    """Check a place, read the images and decide."""
    until_case(trainee, number)
    trainee.choose("check")
    trainee.choose("point Nasion")
    trainee.until(lambda: "nasion" in trainee.view.screen.instruction.text, "the way to the place")
    trainee.press("menu", lambda: trainee.menu is not None, "the case")
    assert trainee.menu.items[1].value == "1"
    trainee.choose("images")
    assert len(trainee.menu.slices.slices) == 3
    trainee.choose("back")
    for item in ("decide", "stop", "60", "bent tool"):
        trainee.choose(item)
    assert trainee.menu_name == "case-truth"


def leave(trainee: OnPage) -> None:
    trainee.choose("leave")
    trainee.choose("leave")
    assert trainee.menu_name == "start"


def test_a_drill_is_carried_on_by_mouse_by_thumbs_and_in_the_headset(place, browser):
    page = open_page(browser, place.url, place.code, draws=False, size=DESKTOP)
    with page.context:
        trainee = ClickingTrainee(place, page)
        for item in ("decide", "begin", "begin"):
            trainee.choose(item)
        play_case(trainee, 1)
        picture = page.locator("#menu img.drawn")
        assert "Residuals" in picture.get_attribute("alt")
        leave(trainee)
        assert page.problems == []
    page = open_page(browser, place.url, place.code, draws=False, size=PHONE, has_touch=True)
    with page.context:
        trainee = SteeringTrainee(place, page)
        for item in ("decide", "continue", "next"):
            trainee.choose(item)
        play_case(trainee, 2)
        leave(trainee)
        assert page.problems == []
    page = open_page(browser, place.url, place.code, "metaQuest3", draws=False)
    with page.context:
        enter_headset(page)
        trainee = HandTrainee(place, page)
        for item in ("decide", "continue", "next"):
            trainee.choose(item)
        play_case(trainee, 3)
        leave(trainee)
        assert page.problems == []
