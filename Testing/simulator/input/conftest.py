"""One SDL for all tests of a process, and gamepads that are plugged into it."""

from __future__ import annotations

import pytest

from rastrainer_simulator.input.gamepads import Gamepads
from Testing.sdl_virtual_gamepad import VirtualGamepad


class Ear:
    """Notes what gamepads tell."""

    def __init__(self):
        self.came, self.went, self.unknown, self.inputs = [], [], [], []

    def take(self, news):
        if news.kind == "moved":
            self.inputs.append((news.number, dict(news.inputs)))
        elif news.kind == "unknown":
            self.unknown.append(news.name)
        else:
            told = self.came if news.kind == "added" else self.went
            told.append((news.number, news.name))


class HeardGamepads(Gamepads):
    """Gamepads that report every poll to an ear."""

    def __init__(self, ear):
        super().__init__()
        self._ear = ear

    def poll(self):
        for news in super().poll():
            self._ear.take(news)


@pytest.fixture
def ear():
    return Ear()


@pytest.fixture
def gamepads(ear):
    gamepads = HeardGamepads(ear)
    yield gamepads
    gamepads.close()


@pytest.fixture
def plugged(gamepads, ear):
    """Return a virtual gamepad that the gamepads have found, and its vibrations."""
    felt = []
    gamepad = VirtualGamepad(lambda *strengths: felt.append(strengths))
    gamepad.plug_in()
    gamepads.poll()
    assert len(ear.came) == 1
    yield gamepad, felt
    if gamepad.is_plugged_in:
        gamepad.unplug()
