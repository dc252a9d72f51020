"""What is pressed on the keyboard in the window, as messages to the simulator."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence

import pygame

from rastrainer_simulator.desktop.connection import ServerConnection
from rastrainer_simulator.net.views.messages import ALIVE, KEY, VISIBILITY

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


def without_late_repeats(
    events: Sequence[pygame.event.Event], is_held: Callable[[int], bool]
) -> list[pygame.event.Event]:
    """Return the events of one look, with at most one repeat of a key, and none once it is up.

    SDL repeats a key until its release is looked at. A window that draws for a second has looked at
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
        self._told = 0.0

    def take(self, event: pygame.event.Event) -> None:
        """Take one of SDL's events."""
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
            self._connection.send(VISIBILITY, isVisible=is_visible)

    def is_held(self, scancode: int) -> bool:
        """Return whether a key, by its SDL scancode, is held."""
        return CODES.get(scancode, "") in self._held

    def keep_alive(self) -> None:
        """Say often enough that what is held is still held."""
        now = time.monotonic()
        if self._held and now - self._told >= ALIVE_S:
            self._connection.send(ALIVE)
            self._told = now

    def tap(self, code: str) -> None:
        """Press and release a key."""
        self._press(code, "")
        self._release(code)

    def _press(self, code: str, text: str) -> None:
        if code:
            self._held.add(code)
            typed = text[:LONGEST_TEXT] if text.isprintable() else ""
            self._connection.send(KEY, code=code, isDown=True, text=typed)

    def _release(self, code: str) -> None:
        if code in self._held:
            self._held.discard(code)
            self._connection.send(KEY, code=code, isDown=False, text="")
