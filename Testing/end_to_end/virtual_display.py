"""A display in memory (Xvfb), and a keyboard on it (XTEST)."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys
import time

import pytest

SIZE = (1920, 1080)
HELD_S = 0.03
# X names of the keys of an American keyboard; letters and digits name themselves.
KEYSYMS = {
    "Enter": "Return",
    "Escape": "Escape",
    "Space": "space",
    "Backspace": "BackSpace",
    "ArrowUp": "Up",
    "ArrowDown": "Down",
    "ArrowLeft": "Left",
    "ArrowRight": "Right",
    "ShiftLeft": "Shift_L",
    "ControlLeft": "Control_L",
    "F12": "F12",
}


class VirtualDisplay:
    """An X server without a screen; ended by the `with` statement.

    Attributes:
        name: for the environment variable DISPLAY.
    """

    def __init__(self, size: tuple[int, int] = SIZE):
        if sys.platform != "linux":
            pytest.skip("a display in memory is an X server, which only Linux has")
        screen = "{}x{}x24".format(*size)
        reading, writing = os.pipe()
        self._process = subprocess.Popen(
            ["Xvfb", "-displayfd", str(writing), "-screen", "0", screen, "-nolisten", "tcp"],
            pass_fds=[writing],
            stderr=subprocess.DEVNULL,
        )
        os.close(writing)
        with os.fdopen(reading) as answer:
            number = answer.readline().strip()
        assert number, "Xvfb has not started"
        self.name = f":{number}"

    def __enter__(self) -> VirtualDisplay:
        return self

    def __exit__(self, *_exception: object) -> None:
        self._process.terminate()
        self._process.wait()


class VirtualKeyboard:
    """Presses keys on a display by XTEST, for the window with the focus."""

    def __init__(self, display: VirtualDisplay):
        self._x = ctypes.CDLL("libX11.so.6")
        self._test = ctypes.CDLL("libXtst.so.6")
        self._x.XOpenDisplay.restype = ctypes.c_void_p
        self._x.XStringToKeysym.restype = ctypes.c_ulong
        self._display = ctypes.c_void_p(self._x.XOpenDisplay(display.name.encode()))
        assert self._display, f"{display.name} cannot be opened"

    def close(self) -> None:
        """Leave the display."""
        self._x.XCloseDisplay(self._display)

    def hold(self, code: str, is_down: bool) -> None:
        """Press a key by its W3C code, or release it."""
        symbol = KEYSYMS.get(code, code.removeprefix("Key").removeprefix("Digit").lower())
        keysym = self._x.XStringToKeysym((KEYSYMS.get(code) or symbol).encode())
        key = self._x.XKeysymToKeycode(self._display, ctypes.c_ulong(keysym))
        self._test.XTestFakeKeyEvent(self._display, key, int(is_down), 0)
        self._x.XFlush(self._display)

    def tap(self, code: str) -> None:
        """Press a key for a moment."""
        self.hold(code, True)
        time.sleep(HELD_S)
        self.hold(code, False)
        time.sleep(HELD_S)
