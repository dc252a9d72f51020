"""A training place: the simulator, a view that watches, its window, and Slicer's side."""

from __future__ import annotations

import json
from collections.abc import Mapping
from contextlib import ExitStack
from functools import cached_property
from pathlib import Path
from typing import IO, ClassVar

from rastrainer.igtl.client import Client
from rastrainer.json_records import camel_case
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.net.limits import LIMITS_FILE
from rastrainer_simulator.virtual.scripted_trial import send_hello
from Testing.end_to_end.fork_server import SLICER_SIDE, shared_fork_server
from Testing.end_to_end.simulator_process import SERVES, SimulatorProcess, paired_key
from Testing.end_to_end.stream_trainee import CarriedTrainee, Trainee, WatchingView
from Testing.end_to_end.virtual_display import VirtualDisplay, VirtualKeyboard
from Testing.end_to_end.virtual_gamepad import SimulatorWithGamepad
from Testing.end_to_end.window_process import WindowProcess
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient

TIMEOUT_S = 600
WITHOUT_GRAPHICS = {"silent_s": 10, "lost_s": 20, "gone_s": 300}
"""Limits of views for a machine that draws a headset's pictures by its processor: seconds each."""
PATIENT = {"silent_s": 60, "lost_s": 600, "gone_s": 600}
"""A browser that is late on a busy machine neither releases the input nor pauses the trial."""


class Place:
    """One simulator and its clients; ended by the `with` statement.

    Attributes:
        simulator: the process.
        url, code, key: of the page; `code` admits a browser, `key` other views.
        view: a spectator.
        records: folder of the journals.
    """

    program: ClassVar[type[SimulatorProcess]] = SimulatorProcess
    options: ClassVar[tuple[str, ...]] = ("--view-port", "0", "--seed", "7", "--no-gamepad")

    def __init__(
        self,
        folder: Path,
        *arguments: str,
        limits: Mapping[str, float] = PATIENT,
        **preferences: str | bool,
    ):
        self._folder = folder
        self.records = folder / "records"
        config = folder / "records-config"
        config.mkdir(parents=True)
        preferences = {"order": "any", **preferences}
        (config / "preferences.json").write_text(json.dumps(preferences), encoding="utf-8")
        views = {camel_case(name): value for name, value in limits.items()}
        (config / LIMITS_FILE).write_text(json.dumps({"views": views}), encoding="utf-8")
        with ExitStack() as stack:
            process = self.program(self.records, *self.options, *arguments)
            self.simulator = stack.enter_context(process)
            self.url, self.code = SERVES.search(self.simulator.next_line()).groups()
            self.key = paired_key(self.url, self.code)
            thread = stack.enter_context(LoopThread())
            watcher = stack.enter_context(ViewClient(thread, self.url, self.key))
            self.view = WatchingView(watcher)
            self._stack = stack.pop_all()

    def __enter__(self) -> Place:
        return self

    def __exit__(self, *_exception: object) -> None:
        self._stack.close()

    @cached_property
    def display(self) -> VirtualDisplay:
        return self._stack.enter_context(VirtualDisplay())

    @cached_property
    def keyboard(self) -> VirtualKeyboard:
        """The keyboard of the window."""
        keyboard = VirtualKeyboard(self.display)
        self._stack.callback(keyboard.close)
        return keyboard

    def open_window(self, name: str, size: tuple[int, int] = (1280, 720)) -> WindowProcess:
        """Open a window and wait until it shows the scene."""
        return self._stack.enter_context(
            WindowProcess(self.display, self.url, self.code, self._folder / name, size)
        )

    def trainee(self, hands: object) -> Trainee:
        """Return a trainee who does everything by hand."""
        return Trainee(self.view, hands)

    def carried_trainee(self, hands: object) -> CarriedTrainee:
        """Return a trainee who uses menus by hand and has the tip carried, to save time."""
        return CarriedTrainee(self.view, hands, self.client())

    def client(self) -> Client:
        """Return a client that may command the simulator."""
        client = self._stack.enter_context(Client(port=self.simulator.port))
        send_hello(client, "carrier")
        return client

    def start_slicer(self, trials: int = 1) -> SlicerProcess:
        """Start Slicer's side, which scores a number of trials and ends."""
        slicer = SlicerProcess(self.simulator.port, self._folder / "study", trials)
        self._stack.callback(slicer.kill)
        return slicer

    def entries(self, kind: str) -> list[dict]:
        """Return the entries of a kind in the latest trial's journal, as far as written."""
        journal = max(self.records.glob("*.journal"), key=_begun)
        lines = journal.read_text(encoding="utf-8").rpartition("\n")[0].splitlines()
        return [entry for entry in map(json.loads, lines) if entry["kind"] == kind]

    @property
    def operators(self) -> set[str]:
        """The devices that operated the latest trial."""
        return {entry["operator"] for entry in self.entries("input")} - {""}


class Lab(Place):
    """A place with a gamepad at the simulator, and a window whose input is soon released."""

    program = SimulatorWithGamepad
    options = ("--view-port", "0")

    def __init__(self, folder: Path, *arguments: str, **preferences: str | bool):
        limits = {"silent_s": 10, "lost_s": TIMEOUT_S}
        super().__init__(folder, *arguments, limits=limits, **preferences)


def _begun(journal: Path) -> str:
    """Return when a trial began, UTC; "" before its first line is written."""
    with journal.open(encoding="utf-8") as lines:
        header = lines.readline()
    return json.loads(header)["utc"] if header.endswith("\n") else ""


class SlicerProcess:
    """Slicer's side, headless, with the shipped scenarios."""

    def __init__(self, port: int, study: Path, trials: int = 1, errors: IO[str] | None = None):
        """Start it; its stderr goes to `errors`, or to our own."""
        words = {
            "port": port,
            "trials": trials,
            "assets": asset_path(),
            "output": study,
            "timeout": 100_000,
        }
        options = [word for name, value in words.items() for word in (f"--{name}", str(value))]
        said = "" if errors is None else errors.name
        self._process = shared_fork_server(SLICER_SIDE).fork(*options, errors=said)
        self.pid = self._process.pid

    def kill(self) -> None:
        """End it as a crash would; a second time changes nothing."""
        self._process.end()

    def events_until(self, event: str) -> list[dict]:
        """Return its events from now on, up to the first event of a kind."""
        received = []
        for line in self._process.stdout:
            received.append(json.loads(line))
            if received[-1]["event"] == event:
                return received
        raise AssertionError(f"Slicer's side has reported no {event}: {received}")

    def results(self) -> dict:
        """Wait for the results of its next trial."""
        return self.events_until("trial")[-1]["results"]
