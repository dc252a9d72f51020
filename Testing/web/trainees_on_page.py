"""Trainees at the page: by gamepad, keys, mouse, two thumbs on a phone, or in a headset."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from playwright.sync_api import Browser, Page

from rastrainer_simulator.flow.session.chosen_trial import FIRST_ID
from Testing.end_to_end.hands import (
    BrowserPad,
    Controllers,
    GamepadHands,
    PageKeys,
    PageMouse,
    Thumbs,
    TrackedHands,
)
from Testing.end_to_end.lab import Lab, Place
from Testing.end_to_end.stream_trainee import (
    LONGEST_WAY_S,
    TRAINEE,
    CarriedTrainee,
    Hands,
    Trainee,
)
from Testing.web.chromium import enter_headset, open_page

PHONE = {"width": 390, "height": 844}
DESKTOP = {"width": 1280, "height": 720}
_SHOWN = """() => {
  const overlay = document.getElementById("overlay");
  const panels = page.headset?.panels;
  const seen = panels
    ? [panels.menu, panels.work, panels.warning].filter((panel) => panel.mesh.visible)
    : [{ root: overlay }];
  return seen.map(({ root }) => [
    panels ? root.textContent : root.innerText,
    ...[...root.querySelectorAll("img")].map((image) => image.alt),
  ].join("\\n")).join("\\n");
}"""
_LISTEN = """() => {
  window.heard = [];
  speechSynthesis.speak = (utterance) => {
    window.heard.push(utterance.text);
    setTimeout(() => utterance.onend());
  };
}"""


class AtPage(Trainee):
    """Reads what the page shows; types the ID on it, or chooses its letters."""

    types_on_page = False
    use: Callable[[Page], Hands]

    def __init__(self, place: Place, page: Page, hands: Hands | None = None):
        super().__init__(place.view, hands or type(self).use(page))
        self.place, self.page = place, page

    def type_id(self, page: Page | None = None) -> None:  # noqa: ARG002
        super().type_id(self.page if self.types_on_page else None)

    def shown(self) -> str:
        """Return all text that is shown at the moment, also in pictures."""
        return self.page.evaluate(_SHOWN)

    def read(self, pattern: str) -> re.Match[str]:
        """Wait until a text is shown."""
        found = None

        def is_shown() -> bool:
            nonlocal found
            found = re.search(pattern, self.shown())
            return found is not None

        self.until(is_shown, pattern)
        return found


class PadTrainee(AtPage):
    """Uses a gamepad at the simulator."""

    def __init__(self, place: Place, page: Page):
        super().__init__(place, page, GamepadHands(place.simulator))


class BrowserPadTrainee(AtPage):
    """Uses a gamepad that the browser reads."""

    use = BrowserPad


class KeyTrainee(AtPage):
    types_on_page, use = True, PageKeys


class ControllerTrainee(AtPage):
    """Uses a headset's controllers."""

    types_on_page, use = True, Controllers


class ListeningTrainee(KeyTrainee):
    """Sees nothing: knows what the page has said since the last choice."""

    def __init__(self, place: Place, page: Page):
        super().__init__(place, page)
        page.evaluate(_LISTEN)

    def shown(self) -> str:
        return "\n".join(self.page.evaluate("heard"))

    def choose(self, item: str) -> None:
        self.page.evaluate("void (window.heard = [])")
        super().choose(item)


class OnPage(AtPage):
    """Chooses items where the page shows them."""

    def choose(self, item: str) -> None:
        """Choose an item of the open menu, which leads to another."""
        before = self.menu_name
        self.until_on_page()
        self.choose_on_page(item)
        self.until(lambda: self.menu_name != before, f"after {item}")

    def go_back(self) -> None:
        self.choose("back")

    def until_on_page(self) -> None:
        """Wait until the page shows the open menu: the previous one may have such an item, too."""
        selector = f"body[data-menu='{self.menu_name or ''}']"
        self.page.wait_for_selector(selector, state="attached")

    def choose_on_page(self, item: str) -> None:
        raise NotImplementedError


class SteeringTrainee(OnPage):
    """Taps on menus, and does everything else with two thumbs."""

    use = Thumbs

    def choose_on_page(self, item: str) -> None:
        self.page.tap(f"#menu li[data-name='{item}'] button")

    def type_id(self, page: Page | None = None) -> None:  # noqa: ARG002
        self.until_on_page()
        self.page.tap("#menu li[data-name=trainee] input")
        self.page.keyboard.insert_text(TRAINEE)
        self.until(lambda: self.value("trainee") == TRAINEE, "the ID")


class TappingTrainee(SteeringTrainee, CarriedTrainee):
    """Taps; commands carry the tip where the thumbs would lead."""

    def __init__(self, place: Place, page: Page):
        CarriedTrainee.__init__(self, place.view, Thumbs(page), place.client())
        self.page = page


class ClickingTrainee(OnPage):
    """Does everything by the mouse."""

    use = PageMouse

    def choose_on_page(self, item: str) -> None:
        self.hands.click(item)

    def type_id(self, page: Page | None = None) -> None:  # noqa: ARG002
        """Add P7 to the ID, a character at a time."""
        before = self.value("trainee").removeprefix(FIRST_ID)
        self.choose("clicked")
        for row, character in (("row 1", "P"), ("row 3", "7")):
            self.choose(row)
            self.choose(character)
        self.choose("done")
        assert self.value("trainee") == f"{before}{TRAINEE}"

    def begin_task(self, task: str) -> None:
        """Go to a task with sticks on the screen."""
        self.choose(task)
        self.until_menu(None)
        self.until(lambda: self.view.scene["task"] == task, "the scene")
        if not self.view.screen.has_sticks:
            self.hands.click("press sticks")
        self.until(lambda: self.view.screen.has_sticks, "the sticks")


class HandTrainee(OnPage):
    """Pinches at the panels' buttons; elsewhere the tip follows the pinching hand."""

    use = TrackedHands

    def choose_on_page(self, item: str) -> None:
        while not (parts := self.parts() & {item, "scroll down"}):
            self.view.next_state()
        if item not in parts:
            self.hands.choose("scroll down")
            self.choose_on_page(item)
        else:
            self.hands.choose(item)

    def parts(self) -> set[str]:
        """Return the menu's parts to point at."""
        return set(self.page.evaluate("page.headset.panels.menu.regions.map(({ name }) => name)"))

    def type_id(self, page: Page | None = None) -> None:  # noqa: ARG002
        self.choose("trainee")
        self.hands.choose("row0")
        self.until(lambda: "A" in self.menu.facts[0].value, "the letter A")
        self.choose("done")

    def steer_to(self, place: np.ndarray, near: float, fine: bool = False) -> None:  # noqa: ARG002
        if self.menu_name == "trial":
            self.choose("resume")
        self._lead(place, lambda: np.linalg.norm(place - self.tip) <= near)

    def sink_onto_skin(self, below: np.ndarray) -> None:
        self._lead(below, lambda: self.view.state["proximity"] == "contact")

    def _lead(self, place: np.ndarray, is_there) -> None:
        self.hands.pinch(True)
        self.hands.carry(place - self.tip)
        give_up = self.view.state["timeS"] + LONGEST_WAY_S
        while not is_there() and self.view.state["timeS"] < give_up:
            self.view.next_state()
        self.hands.pinch(False)


@dataclass(frozen=True)
class Device:
    """How a trainee trains: the input, as it is recorded, and the display.

    `speed` is for steering, in simulated seconds in a second.
    """

    trainee: type[AtPage]
    operator: str
    options: dict[str, Any] = field(default_factory=dict)
    speed: str = "1"
    place: type[Place] = Place


XR = "headset's controllers"
SLOW = "0.3"
"""The speed for hands that a page reads once a picture: if the processor draws, a picture of a
headset takes a quarter of a second, and a stick that is released so late overshoots."""
QUEST_2, QUEST_3 = {"headset": "metaQuest2"}, {"headset": "metaQuest3"}
DEVICES = {
    "keys": Device(KeyTrainee, "keyboard", {"size": {"width": 1920, "height": 1080}}),
    "a gamepad of the browser": Device(BrowserPadTrainee, "browser's gamepad", {"has_pad": True}),
    "controllers": Device(ControllerTrainee, XR, QUEST_2, SLOW),
    "a tracked hand": Device(HandTrainee, XR, QUEST_3, "0.5"),
    "a gamepad in the headset": Device(PadTrainee, "gamepad", QUEST_2, place=Lab),
    "thumbs": Device(SteeringTrainee, "touch screen", {"size": PHONE, "has_touch": True}, "0.5"),
    "the mouse": Device(ClickingTrainee, "mouse", {"size": DESKTOP}, "0.5"),
}


@contextmanager
def at_page(
    device: Device, browser: Browser, folder: Path, *arguments: str, **preferences: str | bool
) -> Iterator[AtPage]:
    """Return a trainee with a device at the page of a new simulator."""
    with device.place(folder, *arguments, **preferences) as place:
        page = open_page(browser, place.url, place.code, draws=False, **device.options)
        with page.context:
            if "headset" in device.options:
                enter_headset(page)
            yield device.trainee(place, page)
            assert page.problems == []
