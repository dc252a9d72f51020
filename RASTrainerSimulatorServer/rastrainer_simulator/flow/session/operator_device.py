"""The device with which the operator works the simulator, and the names of its inputs.

An operator with only a mouse gets two sticks that views draw on request.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce

from rastrainer.protocol import Mode
from rastrainer_simulator.input.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.input.controls import Controls
from rastrainer_simulator.input.inputs import ControlName, InputDevice, SourceKind
from rastrainer_simulator.presentation.screen import PRESS, ControlsPicture, Hint
from rastrainer_simulator.state import OperatorInput
from rastrainer_simulator.texts.texts import NO_NAMES, Texts, input_label, pair_label

_OWN_LABELS = {SourceKind.XR: "headset", SourceKind.TOUCH_SCREEN: "touch screen"}
_BY_MOUSE = "mouse"
"""Devices with their own names of inputs, and the prefix of the keys of these texts."""
SHOW, TILT = "sticks", "tilt"
"""Names of the hints that show or hide the sticks, and have the right stick tilt the tool."""
_SWITCHES = {SHOW: "is_shown", TILT: "is_tilting", ControlName.FINE.value: "is_slow"}


@dataclass(eq=False)
class OperatorDevice:
    """The device of the holder of control, or the likely one before anyone has it.

    `layouts` are the labels of the keys of each view, by their W3C codes.
    """

    controls: Controls
    texts: Texts
    layouts: dict[int, Mapping[str, str]] = field(default_factory=dict)
    screen_sticks: ScreenSticks = field(default_factory=lambda: ScreenSticks())

    @property
    def kind(self) -> InputDevice:
        """The device in use; before anyone acts, a gamepad if there is one."""
        has_keys = self.is_one_of(SourceKind.KEYBOARD, SourceKind.MOUSE)
        is_free = self.controls.holder is None and not self.controls.has_gamepad
        return InputDevice.KEYBOARD if has_keys or is_free else InputDevice.GAMEPAD

    def learned(self, mode: str) -> SourceKind:
        """Return the device that drives the arm, if it has its own controls to be learned."""
        holder = self.controls.holder
        if holder is not None and holder.kind in (SourceKind.XR, SourceKind.TOUCH_SCREEN):
            return holder.kind
        if self.steers_by_mouse:
            return SourceKind.MOUSE
        # In a headset the trainee holds its controllers, unless a gamepad is in use.
        other = SourceKind.XR if mode == Mode.HMD.value else SourceKind.KEYBOARD
        return SourceKind.GAMEPAD if self.kind is InputDevice.GAMEPAD else other

    @property
    def steers_by_mouse(self) -> bool:
        return self.screen_sticks.is_shown and self.is_one_of(SourceKind.MOUSE)

    @property
    def picture(self) -> ControlsPicture:
        return "controllers" if self.is_one_of(SourceKind.XR) else self.kind.value

    def is_one_of(self, *kinds: SourceKind) -> bool:
        holder = self.controls.holder
        return holder is not None and holder.kind in kinds

    def label(self, *controls: ControlName) -> str:
        """Return the first input of a control, or of two that belong together.

        It is on what the operator has in their hands.
        """
        return reduce(pair_label, map(self._label, controls))

    def _label(self, control: ControlName) -> str:
        holder = self.controls.holder
        kind = "" if holder is None else _OWN_LABELS.get(holder.kind, "")
        own = f"{_BY_MOUSE if self.steers_by_mouse else kind}.{control.value}"
        if own in self.texts:
            return self.texts.say(own)
        if self.steers_by_mouse:
            # The sticks of a gamepad with its default bindings.
            return self.input_label(InputDevice.GAMEPAD, DEFAULT_BINDINGS.gamepad[control][0])
        return self.input_label(self.kind, self.controls.bindings.table(self.kind)[control][0])

    def hint(self, key: str, *controls: ControlName, item: str | None = None) -> Hint:
        """Return what controls do; a click presses a single one, or sends back the item."""
        press = PRESS + controls[0].value if len(controls) == 1 else ""
        return Hint(self.label(*controls), self.texts.say(key), press if item is None else item)

    def stick_label(self, controls: Sequence[ControlName]) -> str:
        """Return what moves the tool in some directions: "Left stick", or the keys, "W A S D"."""
        labels = [self.label(control) for control in controls]
        words = [label.split() for label in labels]
        shared = 0
        while all(len(word) > shared and word[shared] == words[0][shared] for word in words):
            shared += 1
        return " ".join(words[0][:shared] or labels)

    def input_label(self, device: InputDevice, name: str) -> str:
        """Return the name of an input; of a key, as on the operator's keyboard if it is known."""
        holder = self.controls.holder
        view = None if holder is None else holder.view
        latest = next(reversed(self.layouts.values()), NO_NAMES)
        names = latest if view is None else self.layouts.get(view, NO_NAMES)
        return input_label(self.texts, device.value, name, names)


@dataclass
class ScreenSticks:
    """Whether the sticks are shown, and their functions that a click switches.

    A mouse pushes one stick at a time and cannot hold a button meanwhile: what other devices hold
    is switched on and off here.

    Attributes:
        is_tilting: whether the right stick tilts the tool in place of lifting and lowering it.
    """

    is_shown: bool = False
    is_slow: bool = False
    is_tilting: bool = False

    def pressed(self, name: str) -> bool:
        """Switch what a click stands for; return whether it concerns the sticks."""
        switched = _SWITCHES.get(name, "")
        if switched:
            setattr(self, switched, not getattr(self, switched))
        return switched != ""

    def moved(
        self, translation: tuple[float, float, float], rotation: tuple[float, float]
    ) -> OperatorInput:
        right, forward, up = translation
        if self.is_tilting:
            rotation, up = (rotation[0], up), 0.0
        is_pushed = any((right, forward, up, *rotation))
        return OperatorInput((right, forward, up), rotation, self.is_slow and is_pushed)
