"""The keys of a keyboard by their place: SDL's scancodes and W3C's `KeyboardEvent.code`.

Both number the keys as the USB HID usage tables do.
"""

from __future__ import annotations

from collections.abc import Mapping

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
