"""A trainee at a phone: menus are tapped, and two thumbs steer."""

from __future__ import annotations

from Testing.web.hands import Thumbs
from Testing.web.place import TRAINEE, CarriedTrainee, OnPage, Trainee

PHONE = {"width": 390, "height": 844}


class Taps(OnPage):
    """Menus by taps on the page."""

    def choose_on_page(self, item: str) -> None:
        self.page.tap(f"#menu li[data-name='{item}'] button")

    def write_id(self) -> None:
        self.until_on_page()
        self.page.tap("#menu li[data-name=trainee] input")
        self.page.keyboard.insert_text(TRAINEE)
        self.until(lambda: self.value("trainee") == TRAINEE, "the ID")

    def begin_by_taps(self, task: str) -> None:
        """Go into a task from wherever the last trainee has stopped."""
        self.go_to_experiment()
        self.write_id()
        self.begin_task(task)
        self.until(lambda: self.view.state["phase"] == "running", "the trial")


class TappingTrainee(Taps, CarriedTrainee):
    """Taps; commands carry the tip where the thumbs would lead."""

    def __init__(self, place, page):
        super().__init__(place.view, Thumbs(page), place.client())
        self.page = page


class SteeringTrainee(Taps, Trainee):
    """Taps, and does everything else with two thumbs."""

    def __init__(self, place, page):
        super().__init__(place.view, Thumbs(page))
        self.page = page
