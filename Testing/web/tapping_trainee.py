"""A trainee at a phone: menus are tapped, and two thumbs steer."""

from __future__ import annotations

from Testing.web.hands import Thumbs
from Testing.web.place import TRAINEE, CarriedTrainee, Trainee

PHONE = {"width": 390, "height": 844}


class Taps:
    """Menus by taps on the page `_page`."""

    def choose(self, item: str) -> None:
        """Tap an item, once the page shows its menu."""
        before = self.menu_name
        self._until_shown()
        self._page.tap(f"#menu li[data-name='{item}'] button")
        self.until(lambda: self.menu_name != before, f"after {item}")

    def write_id(self) -> None:
        self._until_shown()
        self._page.tap("#menu li[data-name=trainee] input")
        self._page.keyboard.insert_text(TRAINEE)
        self.until(lambda: self.value("trainee") == TRAINEE, "the ID")

    def begin_by_taps(self, task: str) -> None:
        """Go into a task from wherever the last one has stopped."""
        self.go_to_experiment()
        self.write_id()
        self.begin_task(task)
        self.until(lambda: self.view.state["phase"] == "running", "the trial")

    def _until_shown(self) -> None:
        self._page.wait_for_selector(f'body[data-menu="{self.menu.name}"]')


class TappingTrainee(Taps, CarriedTrainee):
    """Taps, and is carried by command where the thumbs would lead."""

    def __init__(self, place, page):
        super().__init__(place.view, Thumbs(page), place.client())
        self._page = page


class SteeringTrainee(Taps, Trainee):
    """Taps, and does everything else with two thumbs."""

    def __init__(self, place, page):
        super().__init__(place.view, Thumbs(page))
        self._page = page
