"""Screens are read aloud where that is chosen: once each, and nothing that has gone meanwhile."""

from __future__ import annotations

from rastrainer_simulator.net.views.screen import Fact, Menu, MenuItem, Screen, ScreenMessage
from Testing.web.chromium import open_page, wait_for

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
"""A machine without voices never ends a sentence: the test says when one has been read."""


def spoken(**others):
    return Screen(is_spoken=True, **others)


def heard(page, count):
    """Wait for a number of sentences, and return them all."""
    wait_for(page, f"window.heard.length >= {count}")
    return [text for _language, text in page.evaluate("window.heard")]


def test_what_is_new_is_read_in_its_language_one_sentence_after_the_other(browser, served):
    page = open_page(browser, served.url, served.code, draws=False)
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
    items = (MenuItem("next", "Next task"), MenuItem("again", "Again"))
    menu = Menu("result", "Result", ("Well done.",), (Fact("Score", "81"),), items, focus="again")
    served.tell(spoken(menu=menu, language="zh-Hans"))
    for count in range(3, 7):
        heard(page, count)
        page.evaluate("ended()")
    assert heard(page, 6)[2:] == ["Result", "Well done.", "Score: 81", "Again"]
    assert page.evaluate("window.heard[5][0]") == "zh-CN", "voices are named by region"
    assert page.problems == []


def test_what_is_being_read_stops_when_reading_is_switched_off(browser, served):
    page = open_page(browser, served.url, served.code, draws=False)
    page.evaluate(LISTEN)
    served.tell(spoken(instruction=ScreenMessage("A long sentence.")))
    assert heard(page, 1) == ["A long sentence."]
    served.tell(Screen(instruction=ScreenMessage("A long sentence."), status=("off",)))
    page.wait_for_selector("#status:has-text('off')")
    wait_for(page, "window.reading.length === 0")
    assert heard(page, 1) == ["A long sentence."]
    assert page.problems == []
