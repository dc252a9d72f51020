"""Gamepads through the real SDL: layout, hot plugging, vibration."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest

from rastrainer_simulator.input.gamepads import AXES, BUTTONS
from Testing.sdl_virtual_gamepad import WHEEL, VirtualGamepad


def poll_until(gamepads, condition):
    give_up = time.monotonic() + 60.0
    while not condition():
        assert time.monotonic() < give_up
        gamepads.poll()
        time.sleep(0.002)


def test_each_button_and_each_direction_is_an_input_by_sdls_name(gamepads, plugged):
    gamepad, _felt = plugged
    for button in BUTTONS:
        gamepad.press(button)
        gamepads.poll()
        pressed = {name for name, value in gamepads.moved.inputs.items() if value > 0.0}
        assert pressed == {button}
        gamepad.press(button, False)
    for axis in AXES:
        positions = ((0.5, "+"), (-1.0, "-")) if axis in AXES[:4] else ((1.0, "+"),)
        for position, sign in positions:
            gamepad.move(**{axis: position})
            gamepads.poll()
            inputs = gamepads.moved.inputs
            pushed = {name: inputs[name] for name in inputs if name[1:] == axis}
            assert pushed.pop(sign + axis) == pytest.approx(abs(position), abs=1e-4)
            assert set(pushed.values()) <= {0.0}


def test_a_gamepad_can_be_plugged_and_unplugged_repeatedly(gamepads, plugged):
    gamepad, _felt = plugged
    for times in (1, 2, 3):
        gamepad.unplug()
        gamepads.poll()
        assert gamepads.names("removed") == ["Virtual F310"] * times
        gamepad.plug_in()
        gamepads.poll()
        assert len(gamepads.names("added")) == times + 1
    gamepad.press("a")
    gamepads.poll()
    assert gamepads.moved.inputs["a"] == 1.0


@pytest.mark.usefixtures("plugged")
def test_two_gamepads_are_told_apart(gamepads):
    second = VirtualGamepad(name="Second")
    second.plug_in()
    gamepads.poll()
    second.press("x")
    gamepads.poll()
    numbers = {news.name: news.number for news in gamepads.news if news.kind == "added"}
    assert gamepads.moved.number == numbers["Second"] != numbers["Virtual F310"]
    second.unplug()


def test_the_motors_run_as_strong_and_as_long_as_asked(gamepads, plugged):
    _gamepad, felt = plugged
    gamepads.rumble(0.5, 0.05)
    assert felt == [pytest.approx((0.5, 0.5), abs=1e-4)]
    poll_until(gamepads, lambda: len(felt) == 2)
    assert felt[-1] == (0.0, 0.0)


def test_a_joystick_of_unknown_layout_is_named_once(gamepads):
    wheel = VirtualGamepad(name="Odd wheel", kind=WHEEL)
    wheel.plug_in()
    for _ in range(3):
        gamepads.poll()
    assert gamepads.names("unknown") == ["Odd wheel"]
    assert gamepads.names("added") == []
    wheel.unplug()


def test_a_computer_without_pygame_gets_a_message():
    program = (
        "import sys; sys.modules['pygame'] = None\n"
        "from rastrainer_simulator.input.gamepads import NoGamepadsError, start_sdl\n"
        "try: start_sdl()\n"
        "except NoGamepadsError as error: print(error)\n"
    )
    said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert said.stdout.startswith("pygame-ce cannot be loaded")
    assert said.stderr == ""
