"""The start menu, the settings, and quitting."""

from __future__ import annotations

from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.introduction import ControlsPage, IntroductionPage
from rastrainer_simulator.flow.pages.pin import PinPage
from rastrainer_simulator.flow.pages.session_page import SessionPage
from rastrainer_simulator.flow.session.preferences import (
    OF_A_TRIAL,
    OF_INSTRUCTORS,
    OF_TRAINEES,
    OPTIONS,
    PREFERENCES_FILE,
)
from rastrainer_simulator.net.views.screen import Menu, MenuItem
from rastrainer_simulator.ops.texts.texts import LANGUAGES


class StartPage(SessionPage):
    """Where everything begins. Who has not read the introduction is led through it once."""

    name = "start"

    def menu(self) -> Menu:
        """Return the start menu."""
        items = ("train", "introduction", "controls", "settings", "quit")
        return Menu(
            self.name,
            self.say("start.title"),
            paragraphs=(self.say("start.text"),),
            items=tuple(self.button(item) for item in items),
        )

    def accept(self, item: str) -> None:
        """Open what was chosen."""
        if item == "train" and self.session.has_read_introduction:
            self.session.pages.open(ExperimentPage(self.session))
            return
        pages = {
            "train": IntroductionPage,
            "introduction": IntroductionPage,
            "controls": ControlsPage,
            "settings": SettingsPage,
            "quit": QuitPage,
        }
        self.session.pages.open(pages[item](self.session))

    def back(self) -> None:
        """There is nothing before it."""


class QuitPage(SessionPage):
    """Asks once more before the simulator is shut down."""

    name = "quit"
    first = "stay"

    def menu(self) -> Menu:
        """Return the question."""
        items = (self.button("stay"), self.button("leave"))
        return Menu(self.name, self.say("quit.title"), (self.say("quit.text"),), items=items)

    def accept(self, item: str) -> None:
        """Stay or leave."""
        if item == "leave":
            self.session.quit()
        self.session.pages.close()


class SettingsPage(SessionPage):
    """One choice for each preference; what would change a running trial waits for its end."""

    name = "settings"

    def menu(self) -> Menu:
        """Return the choices."""
        items = tuple(self._item(name) for name in OPTIONS)
        lock = self.session.lock
        pin = (self.button("unlock" if lock.is_locked else "lock"),) if lock.has_pin else ()
        items = (*items, *pin, self.button("back"))
        return Menu(self.name, self.say("settings.title"), items=items)

    def accept(self, item: str) -> None:
        """Go back, ask for the PIN, or lock again."""
        if item == "back":
            self.back()
        elif item == "unlock":
            self.session.pages.open(PinPage(self.session))
        else:
            self.session.lock.lock()

    def step(self, item: str, direction: int) -> None:
        """Choose another option, which counts at once."""
        wanted = self.session.preferences.stepped(item, direction)
        while wanted.language not in self.session.languages:
            wanted = wanted.stepped("language", direction)
        self.session.prefer(wanted)

    def _item(self, name: str) -> MenuItem:
        lock = self.session.lock
        waits = self.session.has_open_trial and name in OF_A_TRIAL
        is_locked = lock.is_locked and name not in OF_TRAINEES
        help_ = self.say("settings.waits") if waits else self._help(name)
        is_enabled = not waits and not is_locked and (lock.has_pin or name not in OF_INSTRUCTORS)
        return self.choice(name, self._value(name), is_enabled=is_enabled, help=help_)

    def _help(self, name: str) -> str:
        if self.session.lock.is_locked and name not in OF_TRAINEES:
            return self.say("settings.locked")
        if name == "language" and set(self.session.languages) != set(LANGUAGES):
            return self.say("window.no font")
        return self.say(f"settings.{name} help", file=PREFERENCES_FILE)

    def _value(self, name: str) -> str:
        value = getattr(self.session.preferences, name)
        if name == "volume":
            return f"{value} %"
        if name in ("coarse", "fine"):
            return f"{value} mm/s"
        if isinstance(value, bool):
            value = "yes" if value else "no"
        return self.say(f"settings.{name}.{value}")
