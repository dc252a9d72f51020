"""The tutorial on a touch screen, by mouse and in a headset, from the ID to the trial run."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import pytest
from playwright.sync_api import Page

from rastrainer_simulator.flow.session.tutorial import TutorialStep, steps_for
from rastrainer_simulator.input.inputs import SourceKind
from Testing.end_to_end.hands import Controllers, PageMouse
from Testing.end_to_end.lab import Place
from Testing.end_to_end.stream_trainee import CarriedTrainee, Trainee
from Testing.end_to_end.window_process import wait_until
from Testing.tutorial_player import TutorialPlayer
from Testing.web.chromium import SMALL, enter_headset, open_page
from Testing.web.trainees_on_page import DESKTOP, PHONE, ClickingTrainee, TappingTrainee


class CarriedClickingTrainee(ClickingTrainee, CarriedTrainee):
    """Clicks and drags; commands carry the tip where the sticks would lead."""

    def __init__(self, place: Place, page: Page):
        CarriedTrainee.__init__(self, place.view, PageMouse(page), place.client())
        self.page = page


class Learner:
    """Does what `TutorialPlayer` asks for, with the mouse; drags with the right button."""

    def __init__(self, trainee: Trainee, page: Page):
        self.trainee, self.page = trainee, page
        self.hands, self.until = trainee.hands, trainee.until

    def turn_view(self):
        self.hands.turn_view(200)

    @property
    def screen(self):
        return self.trainee.view.screen

    def lower(self):
        label = self.trainee.view.state["next"]
        while self.trainee.view.state["touch"] != "on skin":
            self.trainee.approach(label, 0.02)
            self.trainee.lower_onto(label)

    def touch_next(self):
        trainee, label = self.trainee, self.trainee.view.state["next"]

        def is_done():
            return trainee.view.state["next"] != label

        while not is_done():
            trainee.approach(label, 0.02)
            if trainee.lower_onto(label):
                refused = trainee.refused
                is_answered = lambda r=refused: is_done() or trainee.refused > r  # noqa: E731
                trainee.hands.tap("touch")
                with suppress(AssertionError):
                    wait_until(is_answered, f"touch {label}", trainee.again_s)

    def resume(self):
        self.trainee.choose("resume")
        self.trainee.until_menu(None)


class PhoneLearner(Learner):
    """Turns the view by a finger."""

    def turn_view(self):
        send = self.page.context.new_cdp_session(self.page).send
        for kind, x in (("touchStart", 60), ("touchMove", 200), ("touchMove", 330)):
            points = [{"id": 7, "x": x, "y": 300}]
            send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
        send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


class HeadsetLearner(Learner):
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


@dataclass(frozen=True)
class Way:
    """A trainee with a device, and what the step of the view says to them."""

    device: SourceKind
    trainee: Callable[[Place, Page], Trainee]
    learner: type[Learner]
    says: tuple[TutorialStep, str]
    size: dict
    headset: str = ""
    speed: str = "1"


WAYS = (
    Way(
        SourceKind.TOUCH_SCREEN,
        TappingTrainee,
        PhoneLearner,
        (TutorialStep.TURN_VIEW, "drag a finger"),
        PHONE,
    ),
    Way(
        SourceKind.XR,
        lambda place, page: place.carried_trainee(Controllers(page)),
        HeadsetLearner,
        (TutorialStep.LOOK_AROUND, "Turn your head"),
        SMALL,
        "metaQuest2",
    ),
    Way(
        SourceKind.MOUSE,
        CarriedClickingTrainee,
        Learner,
        (TutorialStep.TURN_VIEW, "right"),
        DESKTOP,
        speed="0.5",
    ),
)


@pytest.mark.soak
@pytest.mark.parametrize("way", WAYS, ids=lambda way: way.device.value)
def test_the_tutorial_is_played_from_the_id_to_the_trial_run_with(way, tmp_path, browser):
    """Every step is done by the device, but the tip is carried to the points."""
    rules = {"order": "fixed", "tutorial": "required"}
    with Place(tmp_path, "--speed", way.speed, **rules) as place:
        options = {"size": way.size, "has_touch": way.device is SourceKind.TOUCH_SCREEN}
        page = open_page(browser, place.url, place.code, way.headset, draws=False, **options)
        if way.headset:
            enter_headset(page)
        trainee = way.trainee(place, page)
        trainee.go_to_experiment()
        trainee.type_id(page)
        assert not item(trainee, "trial-run").is_enabled
        if way.device is SourceKind.MOUSE:
            trainee.begin_task("tutorial")
        else:
            trainee.choose("tutorial")
            trainee.until(lambda: place.view.scene["task"] == "trial-run", "the scene")
        mode = "hmd" if way.headset else "desktop"
        player = TutorialPlayer(way.learner(trainee, page), way.device, mode)
        player.play()
        step, words = way.says
        assert words in dict(player.read)[step]
        assert [step for step, _text in player.read] == list(steps_for(way.device, mode))
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
