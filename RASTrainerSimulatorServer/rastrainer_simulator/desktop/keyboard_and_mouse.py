"""Keys and drags in the window, as messages to the simulator."""

from __future__ import annotations

import math
import re
import time
from collections.abc import Callable, Mapping, Sequence
from typing import cast

import pygame

from rastrainer_simulator.desktop.connection import ServerConnection
from rastrainer_simulator.desktop.panels.controls_picture import stick_boxes
from rastrainer_simulator.presentation.messages import (
    Alive,
    KeyInput,
    OrbitInput,
    SticksInput,
    Visibility,
)

_IN_ORDER = (
    (4, "KeyA KeyB KeyC KeyD KeyE KeyF KeyG KeyH KeyI KeyJ KeyK KeyL KeyM"),
    (17, "KeyN KeyO KeyP KeyQ KeyR KeyS KeyT KeyU KeyV KeyW KeyX KeyY KeyZ"),
    (30, "Digit1 Digit2 Digit3 Digit4 Digit5 Digit6 Digit7 Digit8 Digit9 Digit0"),
    (40, "Enter Escape Backspace Tab Space Minus Equal BracketLeft BracketRight Backslash"),
    (50, "Backslash Semicolon Quote Backquote Comma Period Slash CapsLock"),
    (58, "F1 F2 F3 F4 F5 F6 F7 F8 F9 F10 F11 F12 PrintScreen ScrollLock Pause"),
    (73, "Insert Home PageUp Delete End PageDown ArrowRight ArrowLeft ArrowDown ArrowUp"),
    (83, "NumLock NumpadDivide NumpadMultiply NumpadSubtract NumpadAdd NumpadEnter"),
    (89, "Numpad1 Numpad2 Numpad3 Numpad4 Numpad5 Numpad6 Numpad7 Numpad8 Numpad9 Numpad0"),
    (99, "NumpadDecimal IntlBackslash ContextMenu"),
    (103, "NumpadEqual F13 F14 F15 F16 F17 F18 F19 F20 F21 F22 F23 F24"),
    (135, "IntlRo KanaMode IntlYen Convert NonConvert"),
    (224, "ControlLeft ShiftLeft AltLeft MetaLeft ControlRight ShiftRight AltRight MetaRight"),
)

CODES: Mapping[int, str] = {
    first + index: code for first, codes in _IN_ORDER for index, code in enumerate(codes.split())
}
"""SDL scancode → W3C code."""


_WRITING = re.compile(
    r"Key\w|Digit\d|Minus|Equal|Bracket\w+|Back(slash|quote)|Semicolon|Quote|Comma|Period|Slash|Intl\w+"
)
_WRITTEN = (*range(0x21, 0x7F), *range(0xA1, 0x180), *range(0x370, 0x530))
"""Keys that write, and what may be on them: Latin, Greek and Cyrillic letters, and signs."""


def key_names() -> dict[str, str]:
    """Return what is written on the keys of the keyboard in use, by their W3C codes.

    SDL finds the place of a key by what is on it; a window must be open.
    """
    pressed = pygame.key.get_pressed()
    # It is asked for what is written on a key, and answers with what stands at the key's scancode.
    at_scancodes = cast(Callable[[range], Sequence[int]], type(pressed))
    scancodes = at_scancodes(range(len(pressed)))
    places = {CODES.get(scancodes[written], ""): chr(written) for written in reversed(_WRITTEN)}
    return {code: name for code, name in places.items() if _WRITING.fullmatch(code)}


def without_late_repeats(
    events: Sequence[pygame.event.Event], is_held: Callable[[int], bool]
) -> list[pygame.event.Event]:
    """Return the events of one poll, with at most one repeat of a key, and none once it is up.

    SDL repeats a key until its release is polled. A window that draws for a second has polled
    nothing meanwhile: a key that was only tapped would type a row of letters.

    `is_held` returns whether a key, by its SDL scancode, was down before.
    """
    late: set[int] = set()
    first: dict[int, int] = {}
    down: dict[int, bool] = {}
    for index, event in enumerate(events):
        if event.type == pygame.KEYDOWN:
            is_repeat = down.get(event.scancode, is_held(event.scancode))
            if is_repeat and first.setdefault(event.scancode, index) != index:
                late.add(index)
            down[event.scancode] = True
        elif event.type == pygame.KEYUP:
            late.update([first.pop(event.scancode)] if event.scancode in first else [])
            down[event.scancode] = False
    return [event for index, event in enumerate(events) if index not in late]


ALIVE_S = 0.1
LONGEST_TEXT = 16
FOCUS_LOST = frozenset((pygame.WINDOWFOCUSLOST, pygame.WINDOWMINIMIZED))


class OperatorKeys:
    """Reports to the simulator which keys are held."""

    def __init__(self, connection: ServerConnection):
        self._connection = connection
        self._held: set[str] = set()
        self._sent_at = 0.0

    def take(self, event: pygame.event.Event) -> None:
        """Handle one of SDL's events."""
        if event.type == pygame.KEYDOWN:
            self._press(CODES.get(event.scancode, ""), event.unicode)
        elif event.type == pygame.KEYUP:
            self._release(CODES.get(event.scancode, ""))
        elif event.type in FOCUS_LOST:
            # Its release will go to another window: the arm must not run on.
            for code in sorted(self._held):
                self._release(code)
        if event.type in (pygame.WINDOWMINIMIZED, pygame.WINDOWRESTORED):
            is_visible = event.type == pygame.WINDOWRESTORED
            self._connection.send(Visibility(is_visible))

    def is_held(self, scancode: int) -> bool:
        return CODES.get(scancode, "") in self._held

    def keep_alive(self) -> None:
        """Confirm often enough that what is held is still held."""
        now = time.monotonic()
        if self._held and now - self._sent_at >= ALIVE_S:
            self._connection.send(Alive())
            self._sent_at = now

    def tap(self, code: str) -> None:
        self._press(code, "")
        self._release(code)

    def _press(self, code: str, text: str) -> None:
        if code:
            self._held.add(code)
            typed = text[:LONGEST_TEXT] if text.isprintable() else ""
            self._connection.send(KeyInput(code, True, typed))

    def _release(self, code: str) -> None:
        if code in self._held:
            self._held.discard(code)
            self._connection.send(KeyInput(code, False, ""))


LEFT_BUTTON = 1
RIGHT_BUTTON = 3
DEG_PER_HEIGHT = 180.0
"""Angle by which a drag over the window's whole height turns the view."""
ZOOM_PER_NOTCH = 0.9
ZOOM_LIMITS = (0.25, 4.0)
"""Limit for one message; no one turns the wheel faster."""
Push = tuple[float, float]
"""Right and up, −1 to 1 each."""


class ViewMouse:
    """Turns the view by right drag, wheel and pinch.

    It adds up the motion between two pictures, and sends it to the simulator.
    """

    def __init__(self, connection: ServerConnection) -> None:
        self._connection = connection
        self._is_dragging = False
        self._around = self._higher = 0.0
        self._zoom = 1.0

    def take(self, event: pygame.event.Event, height: int) -> None:
        """Handle one of SDL's events; `height` is the window's, in pixels."""
        if event.type in (pygame.MOUSEBUTTONDOWN, pygame.MOUSEBUTTONUP):
            if event.button == RIGHT_BUTTON:
                self._is_dragging = event.type == pygame.MOUSEBUTTONDOWN
        elif event.type == pygame.MOUSEMOTION and self._is_dragging:
            # The scene follows the pointer: the eye moves the opposite way.
            right, down = event.rel
            self._around -= DEG_PER_HEIGHT * right / height
            self._higher += DEG_PER_HEIGHT * down / height
        elif event.type == pygame.MOUSEWHEEL:
            self._zoom *= ZOOM_PER_NOTCH**event.y
        elif event.type == pygame.MULTIGESTURE:
            self._zoom /= max(0.5, 1.0 + 2.0 * event.pinched)
        elif event.type == pygame.WINDOWFOCUSLOST:
            self._is_dragging = False

    def tell(self, is_wanted: bool) -> None:
        """Send the accumulated motion, or drop it."""
        if is_wanted and (self._around, self._higher, self._zoom) != (0.0, 0.0, 1.0):
            nearest, farthest = ZOOM_LIMITS
            self._connection.send(
                OrbitInput(
                    min(180.0, max(-180.0, self._around)),
                    min(180.0, max(-180.0, self._higher)),
                    min(farthest, max(nearest, self._zoom)),
                )
            )
        self._around = self._higher = 0.0
        self._zoom = 1.0


class MouseSticks:
    """Sends the deflection of the sticks, and releases them when the button or the window is left.

    Attributes:
        pushes: deflection of the left and the right stick.
    """

    def __init__(self, connection: ServerConnection) -> None:
        self.pushes: tuple[Push, Push] = ((0.0, 0.0), (0.0, 0.0))
        self._connection = connection
        self._dragged: int | None = None
        self._sent_at = 0.0

    def take(self, event: pygame.event.Event, size: tuple[int, int]) -> bool:
        """Handle one of SDL's events while the sticks are shown; return whether it was for them.

        `size` is the window's, in pixels.
        """
        if event.type == pygame.MOUSEBUTTONDOWN and event.button == LEFT_BUTTON:
            for index, box in enumerate(stick_boxes(size)):
                x, y = event.pos[0] - box.left, event.pos[1] - box.top
                if math.hypot(2 * x / box.width - 1, 2 * y / box.height - 1) <= 1.0:
                    self._dragged = index
                    self._push(event.pos, size)
                    return True
        elif event.type == pygame.MOUSEMOTION and self._dragged is not None:
            self._push(event.pos, size)
        elif (event.type == pygame.MOUSEBUTTONUP and event.button == LEFT_BUTTON) or (
            event.type == pygame.WINDOWFOCUSLOST
        ):
            self.release()
        return False

    def release(self) -> None:
        self._dragged = None
        self._tell(((0.0, 0.0), (0.0, 0.0)))

    def keep_alive(self) -> None:
        """Confirm often enough that what is held is still held."""
        now = time.monotonic()
        if any(map(any, self.pushes)) and now - self._sent_at >= ALIVE_S:
            self._connection.send(Alive())
            self._sent_at = now

    def _push(self, place: tuple[int, int], size: tuple[int, int]) -> None:
        assert self._dragged is not None
        box = stick_boxes(size)[self._dragged]
        x = 2.0 * (place[0] - box.left) / box.width - 1.0
        y = 1.0 - 2.0 * (place[1] - box.top) / box.height
        far = max(1.0, math.hypot(x, y))
        push = (x / far, y / far)
        self._tell((push, (0.0, 0.0)) if self._dragged == 0 else ((0.0, 0.0), push))

    def _tell(self, pushes: tuple[Push, Push]) -> None:
        if pushes == self.pushes:
            return
        self.pushes = pushes
        (right, forward), (turn, up) = pushes
        self._connection.send(
            SticksInput((right, forward, up), (turn, 0.0), fine=False, yaw_deg=0.0)
        )
