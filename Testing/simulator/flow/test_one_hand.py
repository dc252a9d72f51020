"""A trial from the start menu to the last touch by one hand at a gamepad, left or right."""

from __future__ import annotations

import pytest

from rastrainer.journal.journal_file import read_journal
from rastrainer.protocol import Phase
from rastrainer_simulator.input.inputs import ControlName, InputDevice
from rastrainer_simulator.input.presets import LEFT_ALONE, RIGHT_ALONE, presets_of
from Testing.simulator.flow.test_controls_screens import open_the_bindings
from Testing.simulator.flow.trainee import Pad
from Testing.simulator.input.test_bindings import REACH

AXIS_OF = {RIGHT_ALONE: "right", LEFT_ALONE: "left"}


class OneHand(Pad):
    """One hand at a gamepad; it presses nothing that it does not reach.

    Its thumb pushes the stick or presses up or down, not both.
    """

    def __init__(self, trainee, plugged, preset):
        super().__init__(trainee, plugged)
        self._side = AXIS_OF[preset]
        self._reach = REACH[InputDevice.GAMEPAD, preset]
        self._table = presets_of(InputDevice.GAMEPAD)[preset]
        self._pressed = None

    def tap(self, control):
        self._press(ControlName(control), True)
        self._trainee.step()
        self._press(ControlName(control), False)
        self._trainee.step()

    def push(self, right, forward, up, fine):
        is_upright = abs(up) > max(abs(right), abs(forward))
        way = (ControlName.MOVE_UP if up > 0.0 else ControlName.MOVE_DOWN) if is_upright else None
        if self._pressed not in (None, way):
            self._press(self._pressed, False)
        if way is not None:
            self._press(way, True)
        self._pressed = way
        level = (0.0, 0.0) if is_upright else (right, -forward)
        axes = dict(zip((f"{self._side}x", f"{self._side}y"), level, strict=True))
        axes[f"{self._side}trigger"] = float(fine)
        self.plugged.move(**axes)

    def _press(self, control, is_down):
        name = next(each for each in self._table[control] if each in self._reach)
        if name.startswith("+"):
            self.plugged.move(**{name[1:]: float(is_down)})
        elif name.startswith("-"):
            self.plugged.move(**{name[1:]: -float(is_down)})
        else:
            self.plugged.press(name, is_down)


def take_preset(pilot, preset):
    """Choose a layout on the page of the controls, with the usual one."""
    open_the_bindings(pilot)
    pilot.focus("preset")
    usual = pilot.item("preset").value
    while pilot.item("preset").value != preset:
        # The layout counts at once, for the next press, too: the D-pad leads through all of them.
        pilot.tap("right")
        assert pilot.item("preset").value != usual, f"there is no layout {preset}"


@pytest.mark.parametrize(
    ("preset", "title"),
    [
        pytest.param(RIGHT_ALONE, "Right hand alone", id="right"),
        pytest.param(LEFT_ALONE, "Left hand alone", id="left", marks=pytest.mark.soak),
    ],
)
def test_one_hand_goes_through_the_menus_and_touches_all_points(pilot, tmp_path, preset, title):
    take_preset(pilot, title)
    pilot.hands = OneHand(pilot, pilot.hands.plugged, preset)
    while pilot.menu.name != "start":
        before = pilot.menu.name
        pilot.tap("back")
        pilot.until(lambda b=before: pilot.menu.name != b, "the menu before")
    pilot.start("task-1")
    pilot.play("task-1")
    pilot.tap("undo")
    pilot.until(lambda: pilot.touched == 14, "the undo")
    assert pilot.state.training.phase is Phase.RUNNING
    (path,) = (tmp_path / "records").glob("*.journal")
    entries = read_journal(path).of_kind("input")
    assert {entry["operator"] for entry in entries} <= {"gamepad", ""}
