"""A page of the menus."""

from __future__ import annotations

from typing import Any

from rastrainer_simulator.flow.session.open_pages import Page
from rastrainer_simulator.flow.session.session import TrainingSession
from rastrainer_simulator.net.views.screen import ItemKind, MenuItem


class SessionPage(Page):
    """A page that reads and changes the session; it keeps only what belongs to itself."""

    def __init__(self, session: TrainingSession) -> None:
        self.session = session

    def back(self) -> None:
        """Close the page."""
        self.session.pages.close()

    def say(self, key: str, **values: object) -> str:
        """Return a sentence in the chosen language."""
        return self.session.texts.say(key, **values)

    def button(self, name: str, label: str = "", **others: Any) -> MenuItem:
        """Return a button; its label is the page's text of that name."""
        return MenuItem(name, label or self.say(f"{self.name}.{name}"), **others)

    def choice(self, name: str, value: str, **others: Any) -> MenuItem:
        """Return a choice; its label is the page's text of that name."""
        return self.button(name, kind=ItemKind.CHOICE, value=value, **others)
