"""The page on a flat display: menus and touches by keyboard, and by a gamepad of the browser."""

from __future__ import annotations

from urllib.parse import unquote

import pytest

from Testing.end_to_end.hands import BrowserPad, PageKeys
from Testing.end_to_end.lab import Place
from Testing.web.chromium import draw_for_a_while, open_page

LARGEST_PAGE = 1_000_000
LARGEST_SCENE = 5_000_000
ACCENT = "#1b6ad6"


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    folder = tmp_path_factory.mktemp("page")
    with Place(folder, "--speed", "4") as place:
        yield place


@pytest.fixture(scope="module")
def page(place, browser):
    page = open_page(browser, place.url, place.code, has_pad=True, draws=False)
    yield page
    assert page.problems == []


def test_a_trial_is_begun_and_a_touch_undone_by_keyboard(place, page):
    trainee = place.carried_trainee(PageKeys(page))
    trainee.begin("task-1", page)
    page.wait_for_selector("body[data-scene=task-1]")
    page.wait_for_selector("#control:has-text('You drive: keyboard')")
    assert draw_for_a_while(page).std() > 20.0
    trainee.touch_all(1)
    trainee.press("undo", lambda: trainee.touched == 0, "the undo")


def test_a_second_gamepad_takes_the_place_of_an_idle_one_and_an_unknown_one_is_reported(
    place, page
):
    trainee = place.trainee(BrowserPad(page))
    trainee.go_home()
    page.evaluate(
        """() => {
          const idle = { ...structuredClone(pad), index: 0, axes: [0.12, 0, 0, 0] };
          window.pad.index = 1;
          navigator.getGamepads = () => [null, idle, window.pad]; }"""
    )
    before = trainee.menu.focus
    trainee.press("down", lambda: trainee.menu.focus != before, "a step")
    page.evaluate("window.pad.mapping = ''; navigator.getGamepads = () => [window.pad]")
    page.wait_for_selector("text=The browser does not know the layout of this gamepad")
    page.evaluate("window.pad.mapping = 'standard'; window.pad.index = 0")
    page.wait_for_selector("text=The browser does not know the layout", state="detached")


def test_a_click_chooses_an_item_and_the_text_is_the_simulators(place, page):
    trainee = place.trainee(PageKeys(page))
    trainee.go_home()
    page.wait_for_selector("body[data-menu=start]")
    page.click("#menu li[data-name=introduction]")
    trainee.until_menu("introduction")
    page.wait_for_selector("body[data-menu=introduction]")
    assert page.inner_text("#menu h2") == trainee.menu.title


def test_the_introduction_shows_the_device_in_use_with_its_inputs_colored(place, page):
    colored = {}
    for hands in (PageKeys, BrowserPad):
        trainee = place.trainee(hands(page))
        trainee.go_home()
        page.wait_for_selector("body[data-menu=start]")
        trainee.choose("controls")
        page.wait_for_selector("body[data-menu=controls]")
        picture = page.wait_for_selector("#menu img")
        assert picture.evaluate("image => image.decode().then(() => image.naturalWidth)") == 1000
        drawing = unquote(picture.get_attribute("src"))
        colored[hands] = drawing.count(f'fill="{ACCENT}"')
    # W, A, S, D, R, F, Shift, Space, Backspace, C, P and M, and B, Q, E, T, G, X, Z for the view;
    # two sticks, RT, Back and Start, and for the view two directions of the D-pad, LB and RB.
    assert colored == {PageKeys: 19, BrowserPad: 9}


def test_the_menu_of_heads_shows_the_picture_of_the_focused_one(place, page):
    trainee = place.trainee(PageKeys(page))
    trainee.go_to_experiment()
    trainee.choose("scenario")
    trainee.until(lambda: len(trainee.menu.items) > 1, "the available heads")
    trainee.focus("head colin27")
    picture = page.wait_for_selector("#menu img[src$='/scenarios/colin27.png']")
    assert picture.evaluate("image => image.decode().then(() => image.naturalWidth)") == 640
    trainee.focus("back")
    page.wait_for_selector("#menu img", state="detached")


def test_the_page_is_smaller_than_a_megabyte_and_loads_nothing_from_elsewhere(place, page):
    own = (place.url, "data:")
    assert [url for url in page.loaded if not url.startswith(own)] == []
    scenes = [size for url, size in page.loaded.items() if url.endswith(".glb")]
    assert 0 < sum(page.loaded.values()) - sum(scenes) < LARGEST_PAGE
    assert 0 < max(scenes) < LARGEST_SCENE
