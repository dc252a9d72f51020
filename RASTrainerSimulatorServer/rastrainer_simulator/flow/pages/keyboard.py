"""Letters on the screen, for those who have only a gamepad or a headset's controllers."""

from __future__ import annotations

from collections.abc import Callable

from rastrainer_simulator.flow.page import Page
from rastrainer_simulator.flow.screen import Fact, Menu
from rastrainer_simulator.flow.session import Session

ROWS = ("ABCDEFGHIJ", "KLMNOPQRST", "UVWXYZ-_.", "0123456789")


class KeyboardPage(Page):
    """Rows of characters: left and right choose one, accepting types it."""

    name = "keyboard"
    steps_when_accepted = False

    def __init__(self, session: Session, write: Callable[[str, str], None]) -> None:
        super().__init__(session)
        self._write = write
        self._places = [0] * len(ROWS)

    def menu(self) -> Menu:
        """Return the rows, the chosen character of each in brackets."""
        rows = tuple(
            self.choice(f"row{number}", self._row(number), label=self.say("keyboard.row"))
            for number in range(len(ROWS))
        )
        return Menu(
            self.name,
            self.say("keyboard.title"),
            facts=(Fact(self.say("experiment.trainee"), self.session.trainee + "_"),),
            items=(*rows, self.button("delete"), self.button("done")),
        )

    def accept(self, item: str) -> None:
        """Type a character, take one back, or finish."""
        trainee = self.session.trainee
        if item == "done":
            self.back()
        elif item == "delete":
            self._write("trainee", trainee[:-1])
        else:
            number = int(item.removeprefix("row"))
            self._write("trainee", trainee + ROWS[number][self._places[number]])

    def step(self, item: str, direction: int) -> None:
        """Choose the next character of a row."""
        number = int(item.removeprefix("row"))
        self._places[number] = (self._places[number] + direction) % len(ROWS[number])

    def _row(self, number: int) -> str:
        place = self._places[number]
        return " ".join(
            f"[{character}]" if index == place else character
            for index, character in enumerate(ROWS[number])
        )
