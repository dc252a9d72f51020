"""One SDL for all tests of a process, and gamepads that are plugged into it."""

from __future__ import annotations

import pytest

from rastrainer_simulator.input.gamepads import Gamepads
from Testing.sdl_virtual_gamepad import VirtualGamepad


class HeardGamepads(Gamepads):
    """Gamepads whose news are kept."""

    def __init__(self):
        super().__init__()
        self.news = []

    def poll(self):
        self.news += super().poll()

    def names(self, kind):
        return [news.name for news in self.news if news.kind == kind]

    @property
    def moved(self):
        return [news for news in self.news if news.kind == "moved"][-1]


@pytest.fixture
def gamepads():
    gamepads = HeardGamepads()
    yield gamepads
    gamepads.close()


@pytest.fixture
def plugged(gamepads):
    """Return a virtual gamepad that the gamepads have found, and its vibrations."""
    felt = []
    gamepad = VirtualGamepad(lambda *strengths: felt.append(strengths))
    gamepad.plug_in()
    gamepads.poll()
    assert len(gamepads.names("added")) == 1
    yield gamepad, felt
    if gamepad.is_plugged_in:
        gamepad.unplug()
