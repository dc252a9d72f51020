"""The page on a flat display: menus and touches by keyboard, and by a gamepad of the browser."""

from __future__ import annotations

import pytest

from Testing.web.chromium import PATIENCE_MS, SMALL, open_page, pixels
from Testing.web.hands import BrowserPad, PageKeys
from Testing.web.place import Place, scored_trial

LARGEST_PAGE = 1_000_000
LARGEST_SCENE = 5_000_000


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    with Place(tmp_path_factory.mktemp("page"), "--speed", "4") as place:
        yield place


@pytest.fixture(scope="module")
def page(place, browser):
    page = open_page(browser, place.simulator.url, place.simulator.code, has_pad=True)
    yield page
    assert page.problems == []


def test_a_trial_by_keyboard_is_registered_and_scored(place, page):
    trainee = place.trainee(PageKeys(page))
    trainee.begin("task-1", page)
    page.wait_for_selector("body[data-scene=task-1]")
    assert pixels(page).std() > 20.0
    assert "keyboard" in page.inner_text("#control")
    trainee.touch_all(1)
    trainee.press("undo", lambda: trainee.touched == 0, "the undo")
    trainee.touch_all(1)
    trainee.have_touched(15)
    slicer = place.start_slicer()
    trainee.press("touch", lambda: trainee.menu is not None, "the choice")
    trainee.choose("register")
    assert scored_trial(slicer)["mode"] == "desktop"
    trainee.until_menu("result")
    assert trainee.menu.facts[0].label == "Score"
    page.wait_for_selector("#menu dl dd[data-tone]")


def test_the_same_flow_goes_by_a_gamepad_of_the_browser(place, page):
    trainee = place.trainee(BrowserPad(page))
    trainee.until_menu("result")
    trainee.choose("menu")
    trainee.begin("task-2", page)
    before = trainee.tip
    trainee.hands.push(1.0, 0.0, 0.0)
    trainee.until(lambda: trainee.tip[0] > before[0] + 0.01, "a step to the right")
    trainee.hands.push(0.0, 0.0, 0.0)
    assert "gamepad" in page.inner_text("#control")
    trainee.touch_all(1)
    trainee.press("menu", lambda: trainee.menu is not None, "the menu")
    trainee.choose("abort")
    trainee.until_menu("abort")
    trainee.choose("abort")
    trainee.until_menu("experiment")


def test_a_click_chooses_and_the_text_is_what_the_simulator_says(place, page):
    trainee = place.trainee(PageKeys(page))
    trainee.until_menu("experiment")
    page.click("#menu li[data-name=back]")
    trainee.until_menu("start")
    page.wait_for_selector("body[data-menu=start]")
    assert page.inner_text("#menu h1") == trainee.menu.title


def test_the_page_weighs_less_than_a_megabyte_and_loads_nothing_from_elsewhere(place, browser):
    sizes: dict[str, int] = {}
    context = browser.new_context(viewport=SMALL)
    page = context.new_page()
    page.set_default_timeout(PATIENCE_MS)

    def keep(response):
        sizes[response.url] = int(response.headers.get("content-length", 0))

    page.on("response", keep)
    page.goto(f"{place.simulator.url}/#code={place.simulator.code}")
    page.wait_for_selector("body[data-scene]")
    assert all(url.startswith(place.simulator.url) for url in sizes)
    scenes = [size for url, size in sizes.items() if url.endswith(".glb")]
    assert sum(sizes.values()) - sum(scenes) < LARGEST_PAGE
    assert max(scenes) < LARGEST_SCENE
    context.close()
