"""A training place: the simulator with a gamepad, its window, and Slicer's side beside it."""

from __future__ import annotations

import json
import os
import secrets
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.stream_trainee import WatchingView
from Testing.end_to_end.virtual_display import VirtualDisplay, VirtualKeyboard
from Testing.end_to_end.virtual_gamepad import SimulatorWithGamepad
from Testing.end_to_end.window_process import WindowProcess
from Testing.simulator.igtl.servers import LoopThread
from Testing.simulator.view_server.served import ViewClient

SLICER = (sys.executable, "-m", "rastrainer.slicer.headless")
PATIENCE_S = 120
VIEWS = "RASTrainer simulator serves views on "


class Lab:
    """Everything of one training place; ended by the `with` statement.

    Attributes:
        simulator: the process, and its gamepad.
        display, keyboard: those of the window.
        url, key: by which views join.
        view: one that watches.
    """

    def __init__(self, folder: Path, *arguments: str):
        self._folder = folder
        self._stack = ExitStack()
        self.key = secrets.token_urlsafe(32)
        os.environ["RASTRAINER_VIEW_KEY"] = self.key
        try:
            self.simulator = self._stack.enter_context(
                SimulatorWithGamepad(folder / "records", "--view-port", "0", *arguments)
            )
        finally:
            del os.environ["RASTRAINER_VIEW_KEY"]
        line = self.simulator.next_line()
        self.url = line.removeprefix(VIEWS).partition(",")[0]
        thread = LoopThread()
        self._stack.callback(thread.stop)
        self.view = WatchingView(self._stack.enter_context(ViewClient(thread, self.url, self.key)))
        self.display = self._stack.enter_context(VirtualDisplay())
        self.keyboard = VirtualKeyboard(self.display)
        self._stack.callback(self.keyboard.close)

    def __enter__(self) -> Lab:
        return self

    def __exit__(self, *_exception: object) -> None:
        self._stack.close()

    def open_window(self, name: str, *arguments: str) -> WindowProcess:
        """Open a window and wait until it shows the scene."""
        window = self._stack.enter_context(
            WindowProcess(self.display, self.url, self.key, self._folder / name, *arguments)
        )
        window.wait_for_frames()
        return window

    def start_slicer(self) -> subprocess.Popen:
        """Start Slicer's side, which scores one trial and ends."""
        process = subprocess.Popen(
            [
                *(*SLICER, "--port", str(self.simulator.port), "--trials", "1"),
                *("--scenario", str(asset_path("scenarios", "colin27"))),
                *("--output", str(self._folder / "study")),
            ],
            stdout=subprocess.PIPE,
            text=True,
        )
        self._stack.callback(process.kill)
        return process


def trial_of(slicer: subprocess.Popen) -> dict:
    """Wait for the end of Slicer's side and return the results that it tells of its trial."""
    lines = slicer.communicate(timeout=PATIENCE_S)[0].splitlines()
    told = [json.loads(line) for line in lines]
    return next(line for line in told if line["event"] == "trial")
