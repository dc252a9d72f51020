"""The start menu, and leaving."""

from __future__ import annotations

from rastrainer_simulator.flow.page import Page
from rastrainer_simulator.flow.pages.experiment import ExperimentPage
from rastrainer_simulator.flow.pages.introduction import ControlsPage, IntroductionPage
from rastrainer_simulator.flow.pages.settings import SettingsPage
from rastrainer_simulator.flow.screen import Menu


class StartPage(Page):
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


class QuitPage(Page):
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
