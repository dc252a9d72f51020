"""A session from the start menu to the result by every input device: fifteen steered touches.

Only the hands act, and Slicer's side registers and scores their touches.
"""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from Testing.end_to_end.hands import GamepadHands
from Testing.web.chromium import enter_headset, open_page
from Testing.web.hands import BrowserPad, Controllers, PageKeys
from Testing.web.place import WITHOUT_GRAPHICS, Place, scored_trial

pytestmark = pytest.mark.soak

XR = "headset's controllers"


@dataclass(frozen=True)
class Way:
    """How a trainee trains: with which input, on which display."""

    name: str
    hands: type
    operator: str
    headset: str = ""
    device: str = ""
    has_gamepad: bool = False
    speed: str = "1"


SLOW = "0.3"
"""Simulated seconds in a second, for hands that a page reads once a picture: where the processor
draws, a picture of a headset takes a quarter of a second, and a stick that is released so late
overshoots."""
WAYS = (
    Way("the keyboard on the page", PageKeys, "keyboard"),
    Way("a gamepad on the page", BrowserPad, "browser's gamepad"),
    Way("controllers of a Quest 2", Controllers, XR, "metaQuest2", "Meta Quest 2", speed=SLOW),
    Way("controllers of a Quest 3", Controllers, XR, "metaQuest3", "Meta Quest 3", speed=SLOW),
    Way("the gamepad", GamepadHands, "gamepad", "metaQuest2", "Meta Quest 2", has_gamepad=True),
)


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.name)
def test_a_trial_is_played_registered_and_scored_with(way, tmp_path, browser):
    speed = ("--speed", way.speed)
    with Place(tmp_path, *speed, has_gamepad=way.has_gamepad, limits=WITHOUT_GRAPHICS) as place:
        is_of_browser = way.hands is BrowserPad
        page = open_page(
            browser, place.simulator.url, place.simulator.code, way.headset, has_pad=is_of_browser
        )
        if way.headset:
            enter_headset(page)
        hands = way.hands(place.simulator if way.has_gamepad else page)
        trainee = place.trainee(hands)
        trainee.begin("task-1", None if way.has_gamepad else page)
        slicer = place.start_slicer()
        trainee.touch_all()
        trainee.register()
        results = scored_trial(slicer)
        trainee.until_menu("result")
        assert page.problems == []
        mode = "hmd" if way.headset else "desktop"
        assert (results["record"]["mode"], len(place.entries("touch"))) == (mode, 15)
        assert trainee.menu.facts[0].label == "Score"
        assert {entry["operator"] for entry in place.entries("input")} <= {way.operator, ""}
        (registered,) = place.entries("registered")
        display = registered["record"]["display"]
        assert display["kind"] == ("headset" if way.headset else "page")
        assert display["shownFrames"] > 0
        assert display["droppedFrames"] >= 0
        if way.headset:
            assert (display["device"], display["refreshHz"]) == (way.device, 90)
