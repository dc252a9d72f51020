"""A trainee with a mouse alone: clicks on menus and hints, and drags the sticks on the screen."""

from __future__ import annotations

from rastrainer_simulator.presentation.messages import Hello
from Testing.simulator.flow.trainee import Trainee

VIEW = 1


class Mouse:
    """The input of a mouse as a view sends it: clicks on items and hints, and dragged sticks."""

    def __init__(self, trainee: Trainee, kind: str):
        self._trainee = trainee
        trainee.presenter.view_joined(VIEW, Hello(kind))

    def tap(self, control: str) -> None:
        """Click on the hint of a control."""
        self.click(f"press {control}")

    def click(self, item: str) -> None:
        """Click on a hint or an item of the menu, which must be there."""
        screen = self._trainee.presenter.screen
        shown = [hint.item for hint in screen.hints]
        shown += [] if screen.menu is None else [each.name for each in screen.menu.items]
        assert item in shown
        self._trainee.presenter.on_item(VIEW, item)
        self._trainee.step(2)

    def push(self, right: float, forward: float, up: float, fine: bool) -> None:
        """Drag the sticks; slow motion is switched by a click."""
        presenter = self._trainee.presenter
        assert presenter.screen.has_sticks
        is_pushed = bool(right or forward or up)
        if is_pushed and fine != presenter._session.screen_sticks.is_slow:
            presenter.on_sticks(VIEW, (0.0, 0.0, 0.0), (0.0, 0.0), False, 0.0)
            self.click("press fine")
        presenter.on_sticks(VIEW, (right, forward, up), (0.0, 0.0), False, 0.0)

    def turn_view(self, around_deg: float) -> None:
        """Drag with the right button."""
        self._trainee.presenter.on_orbit(VIEW, around_deg, 0.0, 1.0)
        self._trainee.step()


class ClickingTrainee(Trainee):
    """Goes through the menus by clicks."""

    def choose(self, item: str, *menu: str | None) -> None:
        """Click on an item, once its menu takes clicks."""
        self.until(lambda: self.menu.focus, "a focus")
        self.hands.click(item)
        for name in menu:
            self.until_menu(name)
