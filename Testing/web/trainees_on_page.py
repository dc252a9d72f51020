"""Trainees at the page without keys: two thumbs on a phone, the mouse, or a tracked hand."""

from __future__ import annotations

import numpy as np
from playwright.sync_api import Page

from rastrainer_simulator.flow.session.chosen_trial import FIRST_ID
from Testing.end_to_end.hands import PageMouse, Thumbs, TrackedHands
from Testing.end_to_end.lab import Place
from Testing.end_to_end.stream_trainee import LONGEST_WAY_S, TRAINEE, CarriedTrainee, Trainee

PHONE = {"width": 390, "height": 844}
DESKTOP = {"width": 1280, "height": 720}


class OnPage(Trainee):
    """Chooses items where the page shows them."""

    page: Page

    def choose(self, item: str) -> None:
        """Choose an item of the open menu, which leads to another."""
        before = self.menu_name
        self.until_on_page()
        self.choose_on_page(item)
        self.until(lambda: self.menu_name != before, f"after {item}")

    def until_on_page(self) -> None:
        """Wait until the page shows the open menu: the previous one may have such an item, too."""
        selector = f"body[data-menu='{self.menu_name or ''}']"
        self.page.wait_for_selector(selector, state="attached")

    def choose_on_page(self, item: str) -> None:
        raise NotImplementedError


class SteeringTrainee(OnPage):
    """Taps on menus, and does everything else with two thumbs."""

    def __init__(self, place: Place, page: Page):
        super().__init__(place.view, Thumbs(page))
        self.page = page

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

    def __init__(self, place: Place, page: Page):
        super().__init__(place.view, PageMouse(page))
        self.page = page

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
        """Go to a task, or the tutorial, with sticks on the screen."""
        self.choose(task)
        self.until_menu(None)
        shown = "trial-run" if task == "tutorial" else task
        self.until(lambda: self.view.scene["task"] == shown, "the scene")
        if not self.view.screen.has_sticks:
            self.hands.click("press sticks")
        self.until(lambda: self.view.screen.has_sticks, "the sticks")


class HandTrainee(OnPage):
    """Pinches at the panels' buttons; elsewhere the tip follows the pinching hand."""

    def __init__(self, place: Place, page: Page):
        super().__init__(place.view, TrackedHands(page))
        self.page = page

    def choose_on_page(self, item: str) -> None:
        self.hands.choose(item)

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
