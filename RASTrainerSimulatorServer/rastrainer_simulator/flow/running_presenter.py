"""The presenter in the simulator's process: its settings files, its gamepads and its pace."""

from __future__ import annotations

import asyncio
import logging
import time
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

from rastrainer.errors import InputError, RASTrainerError
from rastrainer_simulator.flow.flow_presenter import FlowPresenter
from rastrainer_simulator.flow.session.preferences import (
    PREFERENCES_FILE,
    Preferences,
    read_preferences,
)
from rastrainer_simulator.flow.session.services import FlowServices
from rastrainer_simulator.input.bindings import BINDINGS_FILE, DEFAULT_BINDINGS, read_bindings
from rastrainer_simulator.input.gamepads import Gamepads
from rastrainer_simulator.input.inputs import SIMULATOR_STATION, Source, SourceKind
from rastrainer_simulator.loop.control_loop import ControlLoop

PERIOD_S = 0.005
"""Time between two polls of the gamepad."""
QUIET_S, IDLE_S = 0.01, 0.05
"""The same if none is plugged in, and if nobody drives either; messages of views are processed as
they arrive."""
LONGEST_STEP_S = 0.1
"""A machine that was asleep does not catch up."""

_log = logging.getLogger(__name__)

T = TypeVar("T")


class RunningPresenter:
    """A presenter and its gamepads, and the loop that drives both.

    When the gamepad in use is unplugged, the robot stops at once, the trial is paused and a warning
    says so; the trial can be resumed with the keyboard.
    """

    def __init__(
        self, control_loop: ControlLoop, services: FlowServices, has_gamepad: bool
    ) -> None:
        """Read the settings and start SDL where gamepads are wanted; that may take 0.2 s."""
        config = services.config
        bindings, complaint = _read(config / BINDINGS_FILE, read_bindings, DEFAULT_BINDINGS)
        preferences, other = _read(config / PREFERENCES_FILE, read_preferences, Preferences())
        self.presenter = FlowPresenter(control_loop, services, bindings, preferences)
        self._sources: dict[int, Source] = {}
        self._gamepads: Gamepads | None = None
        for reason in filter(None, (complaint, other)):
            self.presenter.warn(reason, "warning.settings", reason=reason)
        if has_gamepad:
            try:
                self._gamepads = Gamepads()
                self.presenter.rumble = self._gamepads.rumble
            except RASTrainerError as error:
                _log.warning("Gamepads cannot be read: %s.", error)
                self.presenter.warn("gamepad", "warning.no SDL", reason=str(error))

    async def run(self) -> None:
        before = time.monotonic()
        while True:
            quiet_s = IDLE_S if self.presenter.controls.holder is None else QUIET_S
            await asyncio.sleep(PERIOD_S if self._sources else quiet_s)
            now = time.monotonic()
            self.advance(min(now - before, LONGEST_STEP_S))
            before = now

    def advance(self, dt: float) -> None:
        presenter = self.presenter
        for news in () if self._gamepads is None else self._gamepads.poll():
            number = news.number
            if news.kind == "moved":
                presenter.controls.set_inputs(self._sources[number], news.inputs)
            elif news.kind == "removed":
                presenter.unplugged(self._sources.pop(number))
                presenter.warn("gamepad", "warning.unplugged", name=news.name)
            elif news.kind == "unknown":
                presenter.warn("gamepad", "warning.unmapped", name=news.name)
            else:
                # The first gamepad belongs to the simulator's own station.
                taken = {source.station for source in self._sources.values()}
                is_first = SIMULATOR_STATION not in taken
                station = SIMULATOR_STATION if is_first else f"gamepad {number}"
                self._sources[number] = Source(SourceKind.GAMEPAD, station, number=number)
                presenter.controls.add(self._sources[number])
                presenter.warn("gamepad")
        presenter.advance(dt)

    def close(self) -> None:
        self.presenter.close()
        if self._gamepads is not None:
            self._gamepads.close()


def _read(path: Path, read: Callable[[Path], T], default: T) -> tuple[T, str]:
    if not path.exists():
        return default, ""
    try:
        return read(path), ""
    except InputError as error:
        _log.warning("%s", error)
        return default, str(error)
