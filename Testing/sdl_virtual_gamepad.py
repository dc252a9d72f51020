"""A gamepad that only SDL knows of, in the SDL that pygame-ce carries: for tests anywhere."""

from __future__ import annotations

import ctypes
import sys
import time
from collections.abc import Callable
from pathlib import Path

from rastrainer_simulator.input.gamepads import AXES, BUTTONS

GAMECONTROLLER, WHEEL = 1, 2
"""SDL's types of joysticks; a virtual joystick of the first type becomes a game controller."""
FULL = 32767
_TRIGGERS = ("lefttrigger", "righttrigger")

_Update = ctypes.CFUNCTYPE(None, ctypes.c_void_p)
_Rumble = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_uint16, ctypes.c_uint16)


class _Description(ctypes.Structure):
    """`SDL_VirtualJoystickDesc`, version 1."""

    _fields_ = (
        *((name, ctypes.c_uint16) for name in ("version", "type", "axes", "buttons", "hats")),
        *((name, ctypes.c_uint16) for name in ("vendor", "product", "padding")),
        ("button_mask", ctypes.c_uint32),
        ("axis_mask", ctypes.c_uint32),
        ("name", ctypes.c_char_p),
        ("userdata", ctypes.c_void_p),
        ("update", _Update),
        ("set_player_index", ctypes.c_void_p),
        ("rumble", _Rumble),
        ("rumble_triggers", ctypes.c_void_p),
        ("set_led", ctypes.c_void_p),
        ("send_effect", ctypes.c_void_p),
    )


def load_sdl() -> ctypes.CDLL:
    """Return the SDL library that pygame has loaded."""
    import pygame

    package = Path(pygame.__file__).parent
    patterns = {"win32": "SDL2.dll", "darwin": ".dylibs/libSDL2-2*"}
    folder = package if sys.platform in patterns else package.parent / "pygame_ce.libs"
    (path,) = folder.glob(patterns.get(sys.platform, "libSDL2-2*"))
    sdl = ctypes.CDLL(str(path))
    sdl.SDL_JoystickGetDeviceInstanceID.restype = ctypes.c_int32
    sdl.SDL_JoystickFromInstanceID.restype = ctypes.c_void_p
    sdl.SDL_JoystickOpen.restype = ctypes.c_void_p
    return sdl


class VirtualGamepad:
    """One gamepad; it may be plugged in and out, and used from any thread.

    Args:
        felt: is called with the strengths (0 to 1) of the two motors at each call of SDL's.
        name: of the gamepad.
        kind: SDL's type of the joystick.
    """

    def __init__(
        self,
        felt: Callable[[float, float], None] = lambda low, high: None,  # noqa: ARG005
        name: str = "Virtual F310",
        kind: int = GAMECONTROLLER,
    ) -> None:
        self._sdl = load_sdl()
        self._name = name.encode()
        self._kind = kind
        self._joystick: ctypes.c_void_p | None = None
        self._instance = -1

        def rumble(_data: object, low: int, high: int) -> int:
            felt(low / 65535.0, high / 65535.0)
            return 0

        def update(_data: object) -> None:
            self._updates += 1

        self._updates = 0
        self._update = _Update(update)
        self._rumble = _Rumble(rumble)

    @property
    def is_plugged_in(self) -> bool:
        """Whether it is plugged in."""
        return self._joystick is not None

    def plug_in(self) -> None:
        """Appear, with nothing pressed."""
        description = _Description(
            version=1,
            type=self._kind,
            axes=len(AXES),
            buttons=len(BUTTONS),
            vendor=0x046D,
            product=0xC21D,
            button_mask=(1 << len(BUTTONS)) - 1,
            axis_mask=(1 << len(AXES)) - 1,
            name=self._name,
            update=self._update,
            rumble=self._rumble,
        )
        index = self._sdl.SDL_JoystickAttachVirtualEx(ctypes.byref(description))
        assert index >= 0, "SDL has no virtual joysticks"
        self._instance = self._sdl.SDL_JoystickGetDeviceInstanceID(index)
        self._joystick = ctypes.c_void_p(self._sdl.SDL_JoystickOpen(index))
        self.move(**dict.fromkeys(AXES, 0.0))

    def unplug(self) -> None:
        """Disappear."""
        for index in range(self._sdl.SDL_NumJoysticks()):
            if self._sdl.SDL_JoystickGetDeviceInstanceID(index) == self._instance:
                self._sdl.SDL_JoystickDetachVirtual(index)
        self._sdl.SDL_JoystickClose(self._joystick)
        self._joystick = None

    def move(self, **positions: float) -> None:
        """Push axes by SDL's names: sticks −1…1, triggers 0…1."""
        for name, position in positions.items():
            raw = 2.0 * position - 1.0 if name in _TRIGGERS else position
            value = ctypes.c_int16(round(FULL * raw))
            self._sdl.SDL_JoystickSetVirtualAxis(self._joystick, AXES.index(name), value)

    def press(self, name: str, is_down: bool = True) -> None:
        """Press a button by SDL's name, or release it."""
        number = BUTTONS.index(name)
        self._sdl.SDL_JoystickSetVirtualButton(self._joystick, number, int(is_down))

    def tap(self, name: str, seconds: float = 0.0) -> None:
        """Press a button and release it, each until SDL, in another thread, has polled it."""
        for is_down in (True, False):
            self.press(name, is_down)
            time.sleep(seconds)
            # The second poll has begun: the first is over.
            seen = self._updates + 2
            while self._updates < seen and self._joystick is not None:
                time.sleep(0.001)
