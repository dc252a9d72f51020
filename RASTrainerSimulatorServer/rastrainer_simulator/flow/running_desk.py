"""The desk in the simulator's process: its settings files, its gamepads and its pace."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

from rastrainer.errors import InputError, RASTrainerError
from rastrainer_simulator.control_loop import ControlLoop
from rastrainer_simulator.controls.bindings import DEFAULT_BINDINGS
from rastrainer_simulator.controls.bindings_file import FILE_NAME as BINDINGS_FILE
from rastrainer_simulator.controls.bindings_file import read_bindings
from rastrainer_simulator.controls.source import SIMULATOR_SEAT, Source, SourceKind
from rastrainer_simulator.flow.desk import Desk
from rastrainer_simulator.flow.preferences import FILE_NAME as PREFERENCES_FILE
from rastrainer_simulator.flow.preferences import Preferences, read_preferences
from rastrainer_simulator.flow.session import Surroundings

if TYPE_CHECKING:
    from rastrainer_simulator.gamepad.gamepads import Gamepads

PERIOD_S = 0.005
"""Time between two looks at the gamepad."""
QUIET_S = 0.01
"""The same where none is plugged in; what views send is taken as it comes."""
LONGEST_STEP_S = 0.1
"""A machine that was asleep does not make up for it."""

_log = logging.getLogger(__name__)

T = TypeVar("T")


class RunningDesk:
    """A desk, its gamepads, and what keeps both going.

    When a gamepad is unplugged the robot stops at once and a warning says so; the trial goes on,
    because the keyboard can take over, and may be paused by it.

    Attributes:
        desk: what the views look at.
    """

    def __init__(
        self, control_loop: ControlLoop, surroundings: Surroundings, has_gamepad: bool
    ) -> None:
        """Read the settings and start SDL where gamepads are wanted; that may take 0.2 s."""
        config = surroundings.config
        bindings, complaint = _read(config / BINDINGS_FILE, read_bindings, DEFAULT_BINDINGS)
        preferences, other = _read(config / PREFERENCES_FILE, read_preferences, Preferences())
        self.desk = Desk(control_loop, surroundings, bindings, preferences)
        self._sources: dict[int, Source] = {}
        self._gamepads: Gamepads | None = None
        for reason in filter(None, (complaint, other)):
            self.desk.warn(reason, "warning.settings", reason=reason)
        if has_gamepad:
            self._gamepads = self._started()

    async def run(self) -> None:
        """Keep the desk going; never returns."""
        before = time.monotonic()
        while True:
            await asyncio.sleep(PERIOD_S if self._sources else QUIET_S)
            now = time.monotonic()
            self.advance(min(now - before, LONGEST_STEP_S))
            before = now

    def advance(self, dt: float) -> None:
        """Look at the gamepads and go on for `dt` seconds."""
        if self._gamepads is not None:
            self._gamepads.poll()
        self.desk.advance(dt)

    def close(self) -> None:
        """Let go of everything."""
        self.desk.close()
        if self._gamepads is not None:
            self._gamepads.close()

    def gamepad_came(self, number: int, name: str) -> None:  # noqa: ARG002
        """A gamepad was plugged in: the first sits at the simulator's own seat."""
        taken = {source.seat for source in self._sources.values()}
        seat = SIMULATOR_SEAT if SIMULATOR_SEAT not in taken else f"gamepad {number}"
        self._sources[number] = Source(SourceKind.GAMEPAD, seat, number=number)
        self.desk.warn("gamepad")

    def gamepad_moved(self, number: int, inputs: Mapping[str, float]) -> None:
        """A gamepad has moved."""
        self.desk.controls.set_inputs(self._sources[number], inputs)

    def gamepad_went(self, number: int, name: str) -> None:
        """A gamepad was unplugged: what it held is let go."""
        self.desk.controls.forget(self._sources.pop(number))
        self.desk.warn("gamepad", "warning.unplugged", name=name)

    def gamepad_unknown(self, name: str) -> None:
        """A gamepad cannot be used."""
        self.desk.warn("gamepad", "warning.unmapped", name=name)

    def _started(self) -> Gamepads | None:
        from rastrainer_simulator.gamepad.gamepads import Gamepads

        try:
            gamepads = Gamepads(self)
        except RASTrainerError as error:
            _log.warning("Gamepads cannot be read: %s.", error)
            self.desk.warn("gamepad", "warning.no SDL", reason=str(error))
            return None
        self.desk.rumble = gamepads.rumble
        return gamepads


def _read(path: Path, read: Callable[[Path], T], default: T) -> tuple[T, str]:
    """Return what a settings file holds, or the default and why."""
    if not path.exists():
        return default, ""
    try:
        return read(path), ""
    except InputError as error:
        _log.warning("%s", error)
        return default, str(error)
