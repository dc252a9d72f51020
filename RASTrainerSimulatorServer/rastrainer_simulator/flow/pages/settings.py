"""The settings: language, sound, how the arm answers, and the order of the tasks."""

from __future__ import annotations

from rastrainer_simulator.flow.page import Page
from rastrainer_simulator.flow.preferences import OF_THE_SIMULATION, OPTIONS
from rastrainer_simulator.flow.screen import Item, Menu


class SettingsPage(Page):
    """One choice for each preference; what would change a running trial waits for its end."""

    name = "settings"

    def menu(self) -> Menu:
        """Return the choices."""
        items = tuple(self._item(name) for name in OPTIONS)
        return Menu(self.name, self.say("settings.title"), items=(*items, self.button("back")))

    def accept(self, item: str) -> None:
        """Go back."""
        if item == "back":
            self.back()

    def step(self, item: str, direction: int) -> None:
        """Choose another option, which counts at once."""
        self.session.prefer(self.session.preferences.stepped(item, direction))

    def _item(self, name: str) -> Item:
        waits = self.session.has_open_trial and name in OF_THE_SIMULATION
        help_ = self.say("settings.waits") if waits else self.say(f"settings.{name} help")
        return self.choice(name, self._value(name), is_enabled=not waits, help=help_)

    def _value(self, name: str) -> str:
        value = getattr(self.session.preferences, name)
        if name == "volume":
            return f"{value} %"
        if name in ("coarse", "fine"):
            return f"{value} mm/s"
        if isinstance(value, bool):
            value = "yes" if value else "no"
        return self.say(f"settings.{name}.{value}")
