"""Display, OpenGL and gamepads: what the trainee sees and holds."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from rastrainer.errors import RASTrainerError
from rastrainer.python_environment import python_command
from rastrainer_simulator.cli.doctor.check_result import CheckResult, CheckStatus
from rastrainer_simulator.ops.system_paths import chinese_font

KEYBOARD = "The keyboard does everything a gamepad does."


class _Names:
    """Collects the names of the gamepads that SDL finds."""

    def __init__(self) -> None:
        self.known: list[str] = []
        self.unknown: list[str] = []

    def gamepad_added(self, _number: int, name: str) -> None:
        self.known.append(name)

    def gamepad_moved(self, number: int, inputs: Mapping[str, float]) -> None:
        """Ignore the sticks."""

    def gamepad_removed(self, number: int, name: str) -> None:
        """Keep the name of a gamepad that is just unplugged."""

    def gamepad_unknown(self, name: str) -> None:
        self.unknown.append(name)


def check_gamepad(devices: Path = Path("/dev/input")) -> Iterator[CheckResult]:
    """Check the gamepads that SDL finds; on Linux they are below `devices`."""
    # A broken pygame must not keep the other checks from running.
    try:
        from rastrainer_simulator.input.gamepads import Gamepads, NoGamepadsError
    except ImportError:
        return
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


PROBE = "rastrainer_simulator.cli.doctor.graphics"
LONGEST_PROBE_S = 60.0
NO_WINDOW = "The trainee's window cannot open; browsers and headsets can still be used."

_RENDERER, _SOFTWARE_RENDERER = "renderer: ", "software renderer: "


def check_graphics(probe: Sequence[str] = ()) -> Iterator[CheckResult]:
    """Open a hidden window and report its renderer; `probe` is another command that opens one."""
    has_x11_or_wayland = os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")
    if sys.platform.startswith("linux") and not has_x11_or_wayland:
        yield CheckResult(
            "graphics",
            CheckStatus.WARNING,
            f"There is no display. {NO_WINDOW}",
            "Start from a desktop session, or set DISPLAY.",
        )
        return
    try:
        done = subprocess.run(
            probe or python_command(PROBE),
            capture_output=True,
            text=True,
            timeout=LONGEST_PROBE_S,
            check=False,
        )
    except subprocess.TimeoutExpired:
        yield _failure(f"A window did not open within {LONGEST_PROBE_S:g} s.")
        return
    answers = [
        line
        for line in done.stdout.splitlines()
        if line.startswith((_RENDERER, _SOFTWARE_RENDERER))
    ]
    if done.returncode != 0 or not answers:
        reason = (done.stderr.strip().splitlines() or [f"it ended with {done.returncode}"])[-1]
        yield _failure(f"OpenGL does not work: {reason}")
        return
    answer = answers[0]
    renderer = answer.partition(": ")[2]
    if answer.startswith(_SOFTWARE_RENDERER):
        yield CheckResult(
            "graphics",
            CheckStatus.WARNING,
            f"OpenGL works, but the processor draws: {renderer}.",
            "Install the graphics card's driver: rendering is slow without it.",
        )
    else:
        yield CheckResult("graphics", CheckStatus.OK, f"OpenGL works: {renderer}.")


def check_font() -> Iterator[CheckResult]:
    """Check that the window can show Chinese."""
    font = chinese_font()
    if font is not None:
        yield CheckResult("font", CheckStatus.OK, f"Chinese characters are drawn with {font}.")
        return
    remedy = "If you need Chinese, install one, such as Debian's fonts-wqy-microhei"
    yield CheckResult(
        "font",
        CheckStatus.WARNING,
        "No font with Chinese characters was found: the window cannot show Chinese.",
        f"{remedy}, and fontconfig." if sys.platform.startswith("linux") else f"{remedy}.",
    )


def _failure(sentence: str) -> CheckResult:
    remedy = "Install the graphics card's driver, OpenGL 3.2 or newer."
    return CheckResult("graphics", CheckStatus.WARNING, f"{sentence} {NO_WINDOW}", remedy)


def main() -> int:
    """Print the name of OpenGL's renderer; if there is none, print one sentence and return 2."""
    from rastrainer_simulator.desktop.gl_window import GlWindow, is_software_renderer

    try:
        window = GlWindow((320, 240), is_fullscreen=False, is_hidden=True)
    except RASTrainerError as error:
        print(error, file=sys.stderr)
        return 2
    name = window.renderer_name
    print(f"{_SOFTWARE_RENDERER if is_software_renderer(name) else _RENDERER}{name}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
