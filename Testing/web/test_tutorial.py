"""The tutorial on a touch screen and in a headset, from the ID to the trial run."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import dataclass

import pytest
from playwright.sync_api import Page

from rastrainer_simulator.flow.tutorial.steps import TutorialStep
from rastrainer_simulator.input.inputs import SourceKind
from Testing.end_to_end.stream_trainee import StreamTrainee
from Testing.end_to_end.view_learner import ViewLearner
from Testing.tutorial_player import TutorialPlayer
from Testing.web.chromium import SMALL, enter_headset, open_page
from Testing.web.hands import Controllers
from Testing.web.place import WITHOUT_GRAPHICS, Place, Trainee
from Testing.web.tapping_trainee import PHONE, TappingTrainee

REQUIRED = {"order": "fixed", "tutorial": "required"}


class WebLearner(ViewLearner):
    """A trainee at the page."""

    def __init__(self, trainee, page):
        super().__init__(trainee)
        self.page = page


class PhoneLearner(WebLearner):
    """Turns the view by a finger."""

    def turn_view(self):
        send = self.page.context.new_cdp_session(self.page).send
        for kind, x in (("touchStart", 60), ("touchMove", 200), ("touchMove", 330)):
            points = [{"id": 7, "x": x, "y": 300}]
            send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


class HeadsetLearner(WebLearner):
    """Looks aside, and pushes the stick."""

    def turn_view(self):
        half = math.radians(30.0) / 2.0
        self._look(half)
        self.hands.push(0.0, 0.4, 0.0)
        self.until(lambda: "Well done" in self.screen.instruction.text, "the turn of the head")
        self.hands.push(0.0, 0.0, 0.0)
        self._look(0.0)

    def _look(self, half):
        self.page.evaluate(
            "async ([y, w]) => { device.quaternion.set(0, y, 0, w); await frames_(3); }",
            [math.sin(half), math.cos(half)],
        )


class ThumbTrainee(TappingTrainee):
    """Steers by the thumbs, too."""

    steer_to = StreamTrainee.steer_to
    press_on = StreamTrainee.press_on
    lower_onto = StreamTrainee.lower_onto


@dataclass(frozen=True)
class Way:
    """The trainees, by device."""

    name: str
    device: SourceKind
    make_trainee: Callable[[Place, Page], Trainee]
    learner: type[WebLearner]
    headset: str = ""
    speed: str = "1"


SLOW = "0.5"
"""Simulated seconds in a second, for hands on a busy machine."""
WAYS = (
    Way("a touch screen", SourceKind.TOUCH_SCREEN, TappingTrainee, PhoneLearner),
    Way(
        "a headset",
        SourceKind.XR,
        lambda place, page: place.carried_trainee(Controllers(page)),
        HeadsetLearner,
        "metaQuest2",
    ),
    Way("thumbs alone", SourceKind.TOUCH_SCREEN, ThumbTrainee, PhoneLearner, speed=SLOW),
    Way(
        "controllers alone",
        SourceKind.XR,
        lambda place, page: place.trainee(Controllers(page)),
        HeadsetLearner,
        "metaQuest2",
        SLOW,
    ),
)
SAYS = {
    SourceKind.TOUCH_SCREEN: (TutorialStep.TURN_VIEW, "drag a finger"),
    SourceKind.XR: (TutorialStep.LOOK_AROUND, "Turn your head"),
}


@pytest.mark.soak
@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.name)
def test_the_tutorial_is_played_from_the_id_to_the_trial_run_with(way, tmp_path, browser):
    """Every step is done by the device; the first two have the tip carried to the points."""
    with Place(tmp_path, "--speed", way.speed, limits=WITHOUT_GRAPHICS, **REQUIRED) as place:
        has_touch = way.device is SourceKind.TOUCH_SCREEN
        size = PHONE if has_touch else SMALL
        page = open_page(
            browser,
            place.simulator.url,
            place.simulator.code,
            way.headset,
            size=size,
            has_touch=has_touch,
            draws=False,
        )
        if way.headset:
            enter_headset(page)
        trainee = way.make_trainee(place, page)
        trainee.go_to_experiment()
        if has_touch:
            trainee.write_id()
        else:
            trainee.type_id(page)
        assert not item(trainee, "trial-run").is_enabled
        trainee.choose("tutorial")
        trainee.until(lambda: place.view.scene["task"] == "trial-run", "the scene")
        mode = "hmd" if way.headset else "desktop"
        player = TutorialPlayer(way.learner(trainee, page), way.device, mode)
        player.play()
        step, words = SAYS[way.device]
        assert words in dict(player.read)[step]
        (path,) = place.records.glob("*.tutorial")
        content = json.loads(path.read_text())
        assert (content["device"], content["mode"]) == (way.device.value, mode)
        assert max(content["firstErrorMm"], *content["errorsMm"]) < 10.0
        trainee.until_menu("tutorial-done")
        assert item(trainee, "trial-run").is_enabled
        assert list(place.records.glob("*.journal")) == []
        assert page.problems == []


def item(trainee, name):
    return next(each for each in trainee.menu.items if each.name == name)
