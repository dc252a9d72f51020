"""The heads to train on, each with its picture: those that come with us and the user's own."""

from __future__ import annotations

from rastrainer.scenario_library import ListedScenario
from rastrainer_simulator.flow.page import Page
from rastrainer_simulator.flow.screen import Item, Menu
from rastrainer_simulator.flow.session import Session

_PREFIX = "head "
"""No scenario's name has a space: no head is taken for the way back."""


class ScenarioPage(Page):
    """Lists the scenarios; one that cannot be used says why."""

    name = "scenario"

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.first = _PREFIX + session.scenario.name
        self._listing = session.list_scenarios()
        self._wanted = ""

    def menu(self) -> Menu:
        """Return the list, as far as it is known."""
        listed = self._listing.result() if self._listing.done() else []
        text = "scenario.text" if self._listing.done() else "scenario.looking"
        items = tuple(self._item(entry) for entry in listed)
        return Menu(
            self.name,
            self.say("scenario.title"),
            (self.say(text),),
            items=(*items, self.button("back")),
        )

    def accept(self, item: str) -> None:
        """Have a head loaded, or go back."""
        if item == "back":
            self.back()
            return
        self._wanted = item.removeprefix(_PREFIX)
        self.session.use_scenario(self._wanted)

    def advance(self, dt: float) -> None:  # noqa: ARG002
        """Go back when the head that was chosen is there; stay where it was refused."""
        if not self._wanted or self.session.is_being_set_up:
            return
        is_there = self.session.scenario.name == self._wanted
        self._wanted = ""
        if is_there:
            self.back()

    def _item(self, entry: ListedScenario) -> Item:
        is_present = entry.name == self.session.scenario.name
        is_loading = self.session.is_being_set_up
        value = "scenario.loading" if entry.name == self._wanted and is_loading else ""
        value = "scenario.present" if is_present and not value else value
        return Item(
            _PREFIX + entry.name,
            entry.title,
            value=self.say(value) if value else "",
            is_enabled=not entry.problem and not is_loading,
            help=entry.problem or self.say("scenario.help"),
            picture=f"/scenarios/{entry.name}.png" if entry.preview else "",
        )
