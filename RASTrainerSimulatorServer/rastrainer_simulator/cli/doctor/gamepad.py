"""Which gamepads are plugged in, and whether they can be read."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

from rastrainer_simulator.cli.doctor.check_result import CheckResult, CheckStatus
from rastrainer_simulator.input.gamepads import Gamepads, NoGamepadsError

KEYBOARD = "The keyboard does everything a gamepad does."


class _Names:
    """Keeps the names of what SDL finds."""

    def __init__(self) -> None:
        self.known: list[str] = []
        self.unknown: list[str] = []

    def gamepad_came(self, _number: int, name: str) -> None:
        self.known.append(name)

    def gamepad_moved(self, number: int, inputs: Mapping[str, float]) -> None:
        """Where the sticks stand does not matter."""

    def gamepad_went(self, number: int, name: str) -> None:
        """One that leaves in this moment is still named."""

    def gamepad_unknown(self, name: str) -> None:
        self.unknown.append(name)


def check_gamepad(devices: Path = Path("/dev/input")) -> Iterator[CheckResult]:
    """Ask SDL; `devices` is where Linux has what is plugged in."""
    names = _Names()
    try:
        gamepads = Gamepads(names)
    except NoGamepadsError as error:
        yield CheckResult(
            "gamepad", CheckStatus.WARNING, f"Gamepads cannot be read: {error}. {KEYBOARD}"
        )
        return
    gamepads.poll()
    gamepads.close()
    for name in names.known:
        yield CheckResult("gamepad", CheckStatus.OK, f"{name} is plugged in.")
    for name in names.unknown:
        yield CheckResult(
            "gamepad",
            CheckStatus.WARNING,
            f"The layout of {name} is not known. {KEYBOARD}",
            "Switch it to XInput (X on the back of a Logitech F310), or describe it in the "
            "variable SDL_GAMECONTROLLERCONFIG.",
        )
    if names.known or names.unknown:
        return
    if _is_kept_out(devices):
        yield CheckResult(
            "gamepad",
            CheckStatus.WARNING,
            f"Nothing in {devices} may be read. {KEYBOARD}",
            "Add yourself to the group input (sudo usermod -aG input $USER), and log in again.",
        )
    else:
        yield CheckResult(
            "gamepad", CheckStatus.WARNING, f"No gamepad is plugged in. {KEYBOARD}", "Plug one in."
        )


def _is_kept_out(devices: Path) -> bool:
    if not sys.platform.startswith("linux"):
        return False
    events = list(devices.glob("event*"))
    return bool(events) and not any(os.access(path, os.R_OK) for path in events)
