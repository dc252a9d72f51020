"""The page says what is missing: JavaScript, WebGL, the scene that still comes, the right code."""

from __future__ import annotations

import pytest

from Testing.web.chromium import PATIENCE_MS, draw_nothing, launch
from Testing.web.hands import PageKeys
from Testing.web.place import WITHOUT_GRAPHICS, Place

NOTE_LOADING = """
window.told = [];
addEventListener("DOMContentLoaded", () => {
  const place = document.getElementById("loading");
  const note = () => {
    const bar = place.querySelector("progress");
    if (!place.hidden) told.push([place.textContent, bar.value, bar.max]);
  };
  new MutationObserver(note).observe(place, { attributes: true, childList: true, subtree: true });
});
"""
"""What is shown while a scene comes may have gone by the time that one looks."""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    with Place(tmp_path_factory.mktemp("without"), limits=WITHOUT_GRAPHICS) as place:
        yield place


def new_page(browser, **options):
    page = browser.new_context(**options).new_page()
    page.set_default_timeout(PATIENCE_MS)
    return page


def address(place) -> str:
    return f"{place.simulator.url}/#code={place.simulator.code}"


def test_without_javascript_the_page_says_so_in_every_language(place, browser):
    page = new_page(browser, java_script_enabled=False)
    page.goto(place.simulator.url)
    assert "RASTrainer needs JavaScript" in page.inner_text("body")
    assert "RASTrainer braucht JavaScript" in page.inner_text("[lang=de]")
    assert "RASTrainer a besoin de JavaScript" in page.inner_text("[lang=fr]")
    assert "RASTrainer necesita JavaScript" in page.inner_text("[lang=es]")
    assert "RASTrainer 需要 JavaScript" in page.inner_text("[lang=zh-Hans]")
    page.context.close()


def test_the_scene_tells_how_much_of_it_has_come(place, browser):
    page = new_page(browser)
    draw_nothing(page)
    page.add_init_script(NOTE_LOADING)
    page.goto(address(place))
    page.wait_for_selector("body[data-scene]")
    page.wait_for_selector("#loading", state="hidden")
    told = page.evaluate("told")
    page.context.close()
    assert all(text.startswith("Loading the scene: ") for text, _loaded, _total in told)
    (total,) = {total for _text, _loaded, total in told}
    assert 1e6 < total < 5e6
    loaded = [loaded for _text, loaded, _total in told]
    assert loaded == sorted(loaded)
    assert loaded[0] < loaded[-1] == total


def test_without_webgl_menus_are_read_and_chosen_and_the_page_says_what_is_missing(place, driver):
    browser = launch(driver, "--disable-3d-apis")
    page = new_page(browser)
    problems = []
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.goto(address(place))
    page.wait_for_selector("body[data-menu=start]")
    page.wait_for_selector("#warnings li:has-text('WebGL')")
    trainee = place.trainee(PageKeys(page))
    trainee.choose("settings")
    page.wait_for_selector("body[data-menu=settings]")
    assert page.inner_text("#menu h2") == trainee.menu.title
    assert problems == []
    browser.close()


def try_code(page, code):
    """Enter a code, and wait until it is answered: of the one before, the page says the same."""
    page.fill("#code", code)
    with page.expect_response("**/pair"):
        page.click("#pairing button")


def test_a_code_that_is_no_longer_valid_says_so_and_so_does_a_new_one(place, browser):
    # The place has another code afterwards: this test is the last.
    page = new_page(browser, locale="de-DE")
    draw_nothing(page)
    wrong = "000000" if place.simulator.code != "000000" else "000001"
    page.goto(f"{place.simulator.url}/#code={wrong}")
    page.wait_for_selector("#pairing output:has-text('gilt nicht mehr')")
    assert page.get_attribute("html", "lang") == "de-DE"
    # Before it is paired, the page says nothing about the robot.
    assert not page.is_visible("#control")
    for _ in range(3):
        try_code(page, wrong)
        page.wait_for_selector("#pairing output:has-text('nicht der Kopplungscode')")
    try_code(page, wrong)
    page.wait_for_selector("#pairing output:has-text('zeigt jetzt einen neuen Code')")
    page.context.close()
