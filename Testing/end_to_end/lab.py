"""A training place: the simulator with a gamepad, its window, and Slicer's side."""

from __future__ import annotations

import json
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path
from typing import IO

from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.net.limits import LIMITS_FILE
from Testing.end_to_end.simulator_process import SERVES, paired_key
from Testing.end_to_end.stream_trainee import WatchingView
from Testing.end_to_end.virtual_display import VirtualDisplay, VirtualKeyboard
from Testing.end_to_end.virtual_gamepad import SimulatorWithGamepad
from Testing.end_to_end.window_process import WindowProcess
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient

SLICER = (sys.executable, "-m", "rastrainer_headless.main")
TIMEOUT_S = 600
PATIENT = {"views": {"silentS": 10, "lostS": TIMEOUT_S}}
"""A machine that is too busy to draw neither releases held keys nor pauses the trial."""


class Lab:
    """Everything of one training place; ended by the `with` statement.

    Attributes:
        simulator: the process, and its gamepad.
        display, keyboard: the window's display and keyboard.
        records: folder of the journals.
        url: address of the page.
        code, key: admit a browser and other views.
        view: a spectator.
    """

    def __init__(self, folder: Path, *arguments: str, **preferences: str):
        self._folder = folder
        self._preferences = {"order": "any", **preferences}
        self.records = folder / "records"
        with ExitStack() as stack:
            self.simulator = stack.enter_context(self._start(*arguments))
            self.url, self.code = SERVES.search(self.simulator.next_line()).groups()
            self.key = paired_key(self.url, self.code)
            thread = stack.enter_context(LoopThread())
            client = stack.enter_context(ViewClient(thread, self.url, self.key))
            self.view = WatchingView(client)
            self.display = stack.enter_context(VirtualDisplay())
            self.keyboard = VirtualKeyboard(self.display)
            stack.callback(self.keyboard.close)
            self._stack = stack.pop_all()

    def _start(self, *arguments: str) -> SimulatorWithGamepad:
        config = self._folder / "records-config"
        config.mkdir(parents=True)
        (config / LIMITS_FILE).write_text(json.dumps(PATIENT))
        (config / "preferences.json").write_text(json.dumps(self._preferences))
        return SimulatorWithGamepad(self.records, "--view-port", "0", *arguments)

    def __enter__(self) -> Lab:
        return self

    def __exit__(self, *_exception: object) -> None:
        self._stack.close()

    def open_window(self, name: str, size: tuple[int, int] = (1280, 720)) -> WindowProcess:
        """Open a window and wait until it shows the scene."""
        return self._stack.enter_context(
            WindowProcess(self.display, self.url, self.code, self._folder / name, size)
        )

    def start_slicer(self, trials: int = 1) -> SlicerProcess:
        """Start Slicer's side, which scores a number of trials and ends."""
        slicer = SlicerProcess(
            *("--port", str(self.simulator.port), "--trials", str(trials)),
            *("--assets", str(asset_path())),
            *("--output", str(self._folder / "study"), "--timeout", str(TIMEOUT_S)),
        )
        self._stack.callback(slicer.kill)
        return slicer


class SlicerProcess:
    """Slicer's side, headless."""

    def __init__(self, *arguments: str, errors: IO[str] | None = None):
        """Start it; its stderr goes to `errors`, or where our own goes."""
        self._process = subprocess.Popen(
            [*SLICER, *arguments], stdout=subprocess.PIPE, stderr=errors, text=True
        )
        self.pid = self._process.pid

    def kill(self) -> None:
        """End it as a crash would; a second time changes nothing."""
        self._process.kill()
        self._process.wait()

    def events_until(self, event: str) -> list[dict]:
        """Return its events from now on, up to the first event of a kind."""
        received = []
        for line in self._process.stdout:
            received.append(json.loads(line))
            if received[-1]["event"] == event:
                return received
        raise AssertionError(f"Slicer's side has reported no {event}: {received}")
