"""Input devices in hands that have learned how fast the tip follows them."""

from __future__ import annotations

from typing import ClassVar

import numpy as np

from rastrainer_simulator.presentation.messages import Hello
from Testing.sdl_virtual_gamepad import VirtualGamepad
from Testing.simulator.flow.mouse import VIEW, Mouse
from Testing.simulator.flow.trainee import Keys, Pad, Trainee

DEAD_ZONE = 0.12
SPEED_M_S, FINE_SPEED_M_S = 0.15, 0.02
"""The speed grows with the square of the push beyond the dead zone, up to these."""
FASTEST_M_S = 0.1
HELD_SHARE = 0.4
"""Keys are held for parts of a velocity that are this share of its largest, or more."""
HELD_SLOWLY_M_S, RELEASED_FAST_M_S = 0.08, 0.045
"""For less than the first, keys are held with Shift; without it they are released at the second."""
TAP_STEPS, WAIT_LOOKS = 10, 3
"""How many steps of the simulation a tap lasts (0.08 s), and how many looks are waited for."""
KEPT_STICK_SHARE = 0.4
"""A mouse keeps the stick that it drags if its part of the way is this share of the other's."""
DOWN_LAST = 0.3
"""A mouse lowers the tip once less than this share of the way down is left to go level."""
LEVEL_M_S = 0.004
"""A mouse goes level no longer for less than this, if there is more to go up or down."""
STICK_PX = 100.0
"""Radius of a stick on the screen; a mouse pushes it by whole pixels."""
CHANGE_STEPS, POINT_STEPS = 30, 60
"""Steps of the simulation (0.008 s) that it takes a thumb, and a mouse's pointer, to get from one
stick or button on the screen to another."""
THUMB_SD, STICK_SD = 0.04, 0.02
"""How far a thumb lands from where it is meant to be on a screen and on a gamepad's stick, of the
stick's radius."""
FAST_M_S = 0.04
"""Slow motion is left for speeds above this, where leaving it takes time."""
DRAG_DEG, PINCH = 20.0, 2.0
"""A drag over the picture turns the view so far, a pinch takes the eye so much farther away."""


def stick_push(velocity: np.ndarray, is_fine: bool | None = None) -> tuple[np.ndarray, bool]:
    """Return the sticks' push, (3,) float, and whether slowly, for a velocity of the tip, m/s.

    `is_fine` is whether slow motion is on, None if it can be switched at once.
    """
    wanted = float(np.linalg.norm(velocity))
    speed = min(wanted, FASTEST_M_S)
    if is_fine is None:
        is_fine = speed < FINE_SPEED_M_S
    share = min(1.0, speed / (FINE_SPEED_M_S if is_fine else SPEED_M_S))
    push = DEAD_ZONE + (1.0 - DEAD_ZONE) * share**0.5
    return velocity * push / max(wanted, 1e-9), is_fine


class TrainedPad(Pad):
    """Moves the tip at a speed, and zooms out the view, too."""

    BUTTONS: ClassVar = {**Pad.BUTTONS, "view_farther": "leftstick"}

    def __init__(self, trainee: Trainee, plugged: VirtualGamepad) -> None:
        super().__init__(trainee, plugged)
        self._random = np.random.default_rng(3)

    def move(self, velocity: np.ndarray) -> None:
        """Push the sticks for a velocity of the tip, (3,) float, m/s: right, forward, up."""
        push, is_fine = stick_push(velocity)
        push += self._random.normal(0.0, STICK_SD, 3) * (push != 0.0)
        self.push(*push.tolist(), is_fine)

    def stop(self) -> None:
        """Release the sticks."""
        self.push(0.0, 0.0, 0.0, False)


class TrainedKeys(Keys):
    """Holds the keys of the larger parts of a velocity, with Shift for a low one, and taps nearby.

    Keys cannot be pushed less: they are released a little before the tip is there, and after that
    it is seen where this has led.
    """

    CODES: ClassVar = {**Keys.CODES, "view_farther": "KeyZ"}
    released_m_s = 0.01
    """Keys held with Shift are released below this, and below it keys are tapped."""

    def __init__(self, trainee: Trainee) -> None:
        super().__init__(trainee)
        self._parts = np.zeros(3)
        self._is_slow = False
        self._waits = 0

    def move(self, velocity: np.ndarray) -> None:
        """Hold or tap the keys for a velocity of the tip, (3,) float, m/s: right, forward, up."""
        if self._waits > 0:
            self._waits -= 1
        elif self._parts.any():
            least = self.released_m_s if self._is_slow else RELEASED_FAST_M_S
            if ((velocity * self._parts)[self._parts != 0.0] < least).any():
                self.stop()
                self._waits = WAIT_LOOKS
        else:
            self._begin(velocity)

    def stop(self) -> None:
        """Release all keys."""
        self._parts = np.zeros(3)
        self.push(0.0, 0.0, 0.0, False)

    def _begin(self, velocity: np.ndarray) -> None:
        largest = float(np.abs(velocity).max())
        parts = np.where(np.abs(velocity) > HELD_SHARE * largest, np.sign(velocity), 0.0)
        self._is_slow = largest < HELD_SLOWLY_M_S
        self.push(*parts.tolist(), self._is_slow)
        if largest < self.released_m_s:
            self._trainee.step(TAP_STEPS)
            self.stop()
            self._waits = WAIT_LOOKS
        else:
            self._parts = parts


class HeldKeys(TrainedKeys):
    """Keys in hands that do not tap on the way down: they hold until they see that it is green."""

    released_m_s = 0.003


class _OnPicture:
    """Turns and zooms the view by drags over the picture."""

    _trainee: Trainee

    def hold(self, control: str, is_down: bool) -> None:
        """Drag while a control of the view would be held."""
        if is_down:
            around, zoom = (DRAG_DEG, 1.0) if control == "view_right" else (0.0, PINCH)
            self._trainee.presenter.on_orbit(VIEW, around, 0.0, zoom)


class TrainedMouse(_OnPicture, Mouse):
    """Drags one of the sticks on the screen at a time, and clicks the rest.

    After each change it looks where the tip is by now, before it drags.
    """

    def __init__(self, trainee: Trainee) -> None:
        super().__init__(trainee, "page")
        self._stick, self._was_fine, self._waits = "", False, 0

    def show_sticks(self) -> None:
        """Have the sticks shown, which is offered to who clicks."""
        for control in ("best_view", "sticks"):
            self.tap(control)
            self._trainee.step(POINT_STEPS)

    def move(self, velocity: np.ndarray) -> None:
        """Drag a stick for a velocity of the tip, (3,) float, m/s: right, forward, up."""
        if self._waits > 0:
            self._waits -= 1
            return
        level, upright = float(np.linalg.norm(velocity[:2])), abs(float(velocity[2]))
        kept = {"level": level, "upright": upright}.get(self._stick, 0.0)
        stick, is_fine = self._stick, max(level, upright) < FINE_SPEED_M_S
        if kept < KEPT_STICK_SHARE * max(level, upright) or level < LEVEL_M_S < upright:
            # Near the point first above it, then down.
            is_near = max(level, upright) < FASTEST_M_S
            share = DOWN_LAST if velocity[2] < 0.0 and is_near else 1.0
            stick = "level" if level >= max(LEVEL_M_S, share * upright) else "upright"
        if self._was_fine:
            is_fine = max(level, upright) < FAST_M_S
        if (stick, is_fine) != (self._stick, self._was_fine):
            self._change(stick, is_fine)
        else:
            push, _ = stick_push(velocity * ([1, 1, 0] if stick == "level" else [0, 0, 1]), is_fine)
            self.push(*(np.round(STICK_PX * push) / STICK_PX).tolist(), is_fine)

    def stop(self) -> None:
        """Let go of the sticks."""
        self.push(0.0, 0.0, 0.0, self._was_fine)

    def _change(self, stick: str, is_fine: bool) -> None:
        """Point at another stick, and before at the hint for slow motion where it is switched."""
        self.stop()
        self._trainee.step(POINT_STEPS * (1 + (is_fine != self._was_fine)))
        self._stick, self._was_fine, self._waits = stick, is_fine, WAIT_LOOKS


class Thumbs(_OnPicture):
    """Two thumbs on the sticks of a touch screen; a button switches slow motion on and off."""

    def __init__(self, trainee: Trainee) -> None:
        self._trainee = trainee
        self._was_fine = False
        self._random = np.random.default_rng(3)
        trainee.presenter.view_joined(VIEW, Hello("page"))

    def tap(self, control: str) -> None:
        """Tap on a button of the page."""
        self._trainee.presenter.on_press(VIEW, control)
        self._trainee.step(2)

    def move(self, velocity: np.ndarray) -> None:
        """Push the sticks for a velocity of the tip, (3,) float, m/s: right, forward, up."""
        push, is_fine = stick_push(velocity)
        if is_fine != self._was_fine:
            self.stop()
            self._was_fine = is_fine
            self._trainee.step(CHANGE_STEPS)
        level, upright = push[:2] + self._missed(push[:2]), push[2:] + self._missed(push[2:])
        level /= max(1.0, float(np.linalg.norm(level)))
        self.push(*level.tolist(), float(np.clip(upright[0], -1.0, 1.0)), is_fine)

    def push(self, right: float, forward: float, up: float, fine: bool) -> None:
        """Push the sticks, −1…1."""
        self._trainee.presenter.on_sticks(VIEW, (right, forward, up), (0.0, 0.0), fine, 0.0)

    def stop(self) -> None:
        """Lift the thumbs."""
        self.push(0.0, 0.0, 0.0, False)

    def _missed(self, push: np.ndarray) -> np.ndarray:
        """Return how far a thumb lands from a push; it is not on a stick that is not pushed."""
        return self._random.normal(0.0, THUMB_SD, len(push)) * bool(push.any())


HANDS = {
    "keys": TrainedKeys,
    "held keys": HeldKeys,
    "pad": TrainedPad,
    "mouse": TrainedMouse,
    "touch screen": Thumbs,
}
"""The hands by device; a gamepad's hands also take the gamepad."""
