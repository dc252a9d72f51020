"""One SDL for all tests of a process, and gamepads that are plugged into it."""

from __future__ import annotations

import pytest

from rastrainer_simulator.input.gamepads import Gamepads
from Testing.sdl_virtual_gamepad import VirtualGamepad


class Ear:
    """Notes what gamepads tell."""

    def __init__(self):
        self.came, self.went, self.unknown, self.inputs = [], [], [], []

    def gamepad_added(self, number, name):
        self.came.append((number, name))

    def gamepad_moved(self, number, inputs):
        self.inputs.append((number, dict(inputs)))

    def gamepad_removed(self, number, name):
        self.went.append((number, name))

    def gamepad_unknown(self, name):
        self.unknown.append(name)


@pytest.fixture
def ear():
    return Ear()


@pytest.fixture
def gamepads(ear):
    gamepads = Gamepads(ear)
    yield gamepads
    gamepads.close()


@pytest.fixture
def plugged(gamepads, ear):
    """Return a virtual gamepad that the gamepads have found, and what it felt."""
    felt = []
    gamepad = VirtualGamepad(lambda *strengths: felt.append(strengths))
    gamepad.plug_in()
    gamepads.poll()
    assert len(ear.came) == 1
    yield gamepad, felt
    if gamepad.is_plugged_in:
        gamepad.unplug()
