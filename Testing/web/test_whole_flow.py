"""A session from the start menu to the result by every input device: fifteen steered touches.

Only the hands act, and Slicer's side registers and scores their touches.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import pytest

from Testing.end_to_end.hands import BrowserPad, Controllers, GamepadHands, PageKeys
from Testing.end_to_end.lab import Lab, Place
from Testing.end_to_end.stream_trainee import Trainee
from Testing.web.chromium import enter_headset, open_page
from Testing.web.trainees_on_page import (
    DESKTOP,
    PHONE,
    ClickingTrainee,
    HandTrainee,
    SteeringTrainee,
)

pytestmark = pytest.mark.soak

XR = "headset's controllers"


@dataclass(frozen=True)
class Way:
    """How a trainee trains: with which input, on which display."""

    name: str
    trainee: Callable[[Place, Any], Trainee]
    operator: str
    headset: str = ""
    place: type[Place] = Place
    speed: str = "1"
    options: dict = field(default_factory=dict)


SLOW = "0.3"
"""Simulated seconds in a second, for hands that a page reads once a picture: where the processor
draws, a picture of a headset takes a quarter of a second, and a stick that is released so late
overshoots."""
QUEST = "metaQuest2"
WAYS = (
    Way("keyboard", lambda place, page: place.trainee(PageKeys(page)), "keyboard"),
    Way(
        "a gamepad of the browser",
        lambda place, page: place.trainee(BrowserPad(page)),
        "browser's gamepad",
        options={"has_pad": True},
    ),
    Way("controllers", lambda place, page: place.trainee(Controllers(page)), XR, QUEST, speed=SLOW),
    Way("a tracked hand", HandTrainee, XR, "metaQuest3", speed="0.5"),
    Way(
        "a gamepad in the headset",
        lambda place, _page: place.trainee(GamepadHands(place.simulator)),
        "gamepad",
        QUEST,
        Lab,
    ),
    Way(
        "two thumbs",
        SteeringTrainee,
        "touch screen",
        speed="0.5",
        options={"size": PHONE, "has_touch": True},
    ),
    Way("the mouse", ClickingTrainee, "mouse", speed="0.5", options={"size": DESKTOP}),
)


@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.name)
def test_a_trial_is_played_registered_and_scored_with(way, tmp_path, browser):
    with way.place(tmp_path, "--speed", way.speed) as place:
        page = open_page(browser, place.url, place.code, way.headset, draws=False, **way.options)
        if way.headset:
            enter_headset(page)
        trainee = way.trainee(place, page)
        trainee.begin("task-1", page if way.operator in ("keyboard", XR) else None)
        slicer = place.start_slicer()
        trainee.play_to_result()
        assert slicer.results()["record"]["mode"] == ("hmd" if way.headset else "desktop")
        assert page.problems == []
        assert len(place.entries("touch")) == 15
        assert place.operators == {way.operator}
        (registered,) = place.entries("registered")
        display = registered["record"]["display"]
        assert display["kind"] == ("headset" if way.headset else "page")
        assert display["shownFrames"] > 0
        assert display["droppedFrames"] >= 0
        if way.headset == QUEST:
            assert (display["device"], display["refreshHz"]) == ("Meta Quest 2", 90)
