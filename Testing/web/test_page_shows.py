"""The page shows a screen's errors, plots, legend and menus, and reads sentences aloud."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest
from coloraide import Color

from rastrainer_simulator.presentation.look import BANNERS
from rastrainer_simulator.presentation.screen import (
    ErrorArrow,
    Fact,
    HeadSlices,
    Hint,
    Menu,
    MenuItem,
    Screen,
    ScreenMessage,
    Tone,
)
from Testing.end_to_end.window_process import wait_until
from Testing.simulator.flow.scored_journals import task_menu
from Testing.web.chromium import open_page, resize, show, wait_for

SIZE = {"width": 1280, "height": 720}


@pytest.fixture(scope="module")
def opened(browser, served):
    page = open_page(browser, served.url, served.code, size=SIZE, draws=False)
    yield page
    assert page.problems == []


@pytest.fixture
def page(opened, served):
    """The page, which shows nothing yet."""
    show(opened, served, Screen())
    return opened


DRAWN = """
() => page.errors.group.children
  .filter((mesh) => mesh.geometry.type === "SphereGeometry")
  .map((mesh) => [mesh.material.color.getHexString(), ...mesh.position.toArray()])
"""


def test_arrows_and_named_checkpoints_appear_and_disappear_with_the_screen(page, served):
    place = (0.5, 0.0, 0.4)
    ends = ((0.5, 0.0, height) for height in (0.41, 0.42, 0.43))
    arrows = tuple(map(ErrorArrow, [place] * 3, ends, (Tone.GOOD, Tone.WARNING, Tone.ERROR)))
    checkpoint = ErrorArrow(place, place, Tone.WARNING, "Left forehead")
    hints = (Hint("Esc", "Result", "back"), Hint("D", "Turn"))
    served.tell(Screen(errors=(*arrows, checkpoint), hints=hints))
    wait_for(page, "page.errors.group.children.length === 8")
    drawn = page.evaluate(DRAWN)
    assert [color for color, *_ in drawn] == ["8ff0d0", "ffe000", "ef5f66", "ffe000"]
    assert [end for _color, *end in drawn[:3]] == [pytest.approx(list(each.end)) for each in arrows]
    named = "page.errors.group.children.filter((child) => child.isSprite)"
    assert page.evaluate(f"{named}.map((name) => name.position.toArray())") == [list(place)]
    # A user with only a mouse can go back, too.
    assert page.locator("#hints button").count() == 1
    page.click("#hints button:has-text('Result')")
    (view,) = {call[1] for call in served.presenter.calls if call[0] == "view_joined"}
    served.wait_for_call("on_item", view, "back")
    pictures = [call[2:] for call in served.presenter.calls if call[0] == "on_picture"]
    # How much of it was loaded before depends on the pieces in which it came.
    assert (pictures[0], pictures[-1]) == (("", 0), ("", 1))
    served.tell(Screen())
    wait_for(page, "page.errors.group.children.length === 0")


def test_a_finger_leads_back_from_what_is_only_watched(browser, served):
    page = open_page(browser, served.url, served.code, has_touch=True, draws=False, has_scene=False)
    hints = (Hint("Arrows", "Turn"), Hint("Esc", "Result", "back"), Hint("Space", "Space", "play"))
    for width, height in ((390, 844), (844, 390)):
        resize(page, width, height)
        show(page, served, Screen(hints=hints))
        assert page.locator("#touch-controls").is_hidden()
        assert page.locator("#hints li:visible").all_inner_texts() == ["Result", "Space"]
        page.tap("#hints button:has-text('Result')")
        (*_, view) = (call[1] for call in served.presenter.calls if call[0] == "view_joined")
        served.wait_for_call("on_item", view, "back")
        served.presenter.calls.remove(("on_item", view, "back"))
        # While something is adjusted, the buttons under the thumbs do the same.
        show(page, served, Screen(hints=(Hint("Space", "Touch", "press touch"),)))
        assert page.locator("#touch-controls").is_visible()
        assert page.locator("#hints").is_hidden()
    page.context.close()


PICTURE = "#menu img"


def test_the_plot_is_beside_the_tasks_and_every_score_is_in_its_text(page, served, loop, outside):
    served.tell(task_menu(loop, outside.services))
    page.wait_for_selector(PICTURE)
    wait_for(page, f"document.querySelector('{PICTURE}').naturalWidth > 0")
    plot, tasks = page.locator(PICTURE), page.locator("#menu ul")
    scores = re.findall(r"\d+", plot.get_attribute("alt"))
    assert scores == ["38", "52", "47", "67", "71", "69", "88"]
    place, beside = plot.bounding_box(), tasks.bounding_box()
    assert place["width"] > 200
    assert place["x"] + place["width"] <= beside["x"]


HAS_AZERTY = """
const map = new Map([["KeyQ", "a"], ["KeyA", "q"], ["Enter", "Enter"], ["KeyX", "Dead"]]);
const value = { getLayoutMap: async () => map };
Object.defineProperty(navigator, "keyboard", { value, configurable: true });
page.keyboard.tellNames();
"""
PRESS_Z = """
window.dispatchEvent(new KeyboardEvent("keydown", { code: "KeyW", key: "Z", shiftKey: true }));
window.dispatchEvent(new KeyboardEvent("keyup", { code: "KeyW", key: "Z" }));
"""


def test_the_page_names_the_keys_as_the_browser_or_a_press_tells(page, served):
    def told():
        return [call[2] for call in served.presenter.calls if call[0] == "on_layout"]

    page.evaluate(HAS_AZERTY)
    wait_until(lambda: any(keys.get("KeyA") == "q" for keys in told()), "the browser's names")
    assert "Enter" not in told()[-1]
    page.evaluate(PRESS_Z)
    wait_until(lambda: told()[-1].get("KeyW") == "z", "the name of the pressed key")
    served.tell(Screen(menu=Menu("controls", "Controls", picture="keyboard")))
    page.wait_for_selector(PICTURE)
    drawn = page.evaluate(f"decodeURIComponent(document.querySelector('{PICTURE}').src)")
    assert re.findall(r">(\w)</text>", drawn)[10:13] == ["A", "Z", "E"]


def test_banners_have_the_colors_that_everybody_can_tell_apart(page, served):
    color = "banner => getComputedStyle(banner).backgroundColor"
    for tone, wanted in BANNERS.items():
        said = ScreenMessage("Touch point 1.", tone)
        show(page, served, Screen(instruction=said, warnings=(said,)))
        for banner in ("#instruction", "#warnings li"):
            assert Color(page.eval_on_selector(banner, color)) == Color(wanted).convert("srgb")


LISTEN = """
window.heard = [];
window.reading = [];
speechSynthesis.speak = (utterance) => {
  window.heard.push([utterance.lang, utterance.text]);
  window.reading.push(utterance);
};
speechSynthesis.cancel = () => window.ended();
window.ended = () => window.reading.shift()?.onend();
"""
"""A machine without voices never ends a sentence: the test ends each."""


def spoken(**others):
    return Screen(is_spoken=True, **others)


def heard(page, count):
    """Wait for a number of sentences, and return them all."""
    wait_for(page, f"window.heard.length >= {count}")
    return [text for _language, text in page.evaluate("window.heard")]


def test_new_text_is_read_aloud_in_its_language_one_sentence_after_the_other(page, served):
    page.evaluate(LISTEN)
    served.tell(Screen(instruction=ScreenMessage("Not read."), status=("quiet",)))
    page.wait_for_selector("#status:has-text('quiet')")
    warned = (ScreenMessage("Contact."),)
    served.tell(spoken(instruction=ScreenMessage("Touch point 1."), warnings=warned, language="de"))
    assert heard(page, 1) == ["Contact."]
    gone = ScreenMessage("Touch point 2.")
    served.tell(spoken(instruction=gone, warnings=warned, status=("two",), language="de"))
    page.wait_for_selector("#status:has-text('two')")
    last = ScreenMessage("Touch point 3.")
    served.tell(spoken(instruction=last, warnings=warned, status=("three",), language="de"))
    page.wait_for_selector("#status:has-text('three')")
    page.evaluate("ended()")
    assert heard(page, 2) == ["Contact.", "Touch point 3."]
    page.evaluate("ended()")
    assert page.evaluate("window.heard.map(([language]) => language)") == ["de", "de"]
    items = (MenuItem("next", "Next task"), MenuItem("again", "Again", help="Once more."))
    menu = Menu("result", "Result", ("Well done.",), (Fact("Score", "81"),), items, focus="again")
    menu = replace(menu, slices=HeadSlices("Through the target.", (), ()))
    served.tell(spoken(menu=menu, language="zh-Hans"))
    said = ["Result", "Well done.", "Score: 81", "Through the target.", "Again", "Once more."]
    for count in range(3, 3 + len(said)):
        heard(page, count)
        page.evaluate("ended()")
    assert heard(page, 2 + len(said))[2:] == said
    assert page.evaluate("window.heard[5][0]") == "zh-CN", "voices are named by region"


def test_reading_stops_when_it_is_switched_off(page, served):
    page.evaluate(LISTEN)
    served.tell(spoken(instruction=ScreenMessage("A long sentence.")))
    assert heard(page, 1) == ["A long sentence."]
    served.tell(Screen(instruction=ScreenMessage("A long sentence."), status=("off",)))
    page.wait_for_selector("#status:has-text('off')")
    wait_for(page, "window.reading.length === 0")
    assert heard(page, 1) == ["A long sentence."]
