"""A training place without a window: the simulator, a view that watches, and Slicer's side."""

from __future__ import annotations

import json
import secrets
import subprocess
import sys
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer_simulator.assets import asset_path
from Testing.end_to_end.stream_trainee import StreamTrainee, WatchingView
from Testing.end_to_end.viewed_simulator import ViewedSimulator
from Testing.simulator.igtl.servers import LoopThread
from Testing.simulator.view_server.served import ViewClient

SLICER = (sys.executable, "-m", "rastrainer.slicer.headless")
PATIENCE_S = 60
MM = 1000.0


class Place:
    """One simulator and who is around it; ended by the `with` statement.

    Attributes:
        simulator: the process.
        view: one that watches.
        records: folder of the journals.
    """

    def __init__(self, folder: Path, *arguments: str):
        self._stack = ExitStack()
        self._folder = folder
        self.records = folder / "records"
        config = folder / "records-config"
        config.mkdir()
        (config / "preferences.json").write_text('{"order": "any"}', encoding="utf-8")
        key = secrets.token_urlsafe(32)
        options = ("--view-port", "0", "--seed", "7", *arguments)
        self.simulator = self._stack.enter_context(ViewedSimulator(self.records, *options, key=key))
        thread = LoopThread()
        self._stack.callback(thread.stop)
        watcher = self._stack.enter_context(ViewClient(thread, self.simulator.url, key))
        self.view = WatchingView(watcher)

    def __enter__(self) -> Place:
        return self

    def __exit__(self, *_exception: object) -> None:
        self._stack.close()

    def trainee(self, hands: object) -> Trainee:
        client = self._stack.enter_context(Client(port=self.simulator.port))
        hello = {"protocolVersion": PROTOCOL_VERSION, "client": "carrier"}
        assert client.send_command("Hello", hello, timeout=20).ok
        return Trainee(self.view, hands, client)

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

    def entries(self) -> list[dict]:
        """Return the lines of the latest trial's journal."""
        journal = max(self.records.glob("*.journal"), key=lambda path: path.stat().st_mtime)
        return [json.loads(line) for line in journal.read_text(encoding="utf-8").splitlines()]


class Trainee(StreamTrainee):
    """Goes through the menus by the hands, and has the tip carried by commands to be quick."""

    def __init__(self, view: WatchingView, hands: object, client: Client):
        super().__init__(view, hands)
        self._client = client

    def steer_to(self, place: np.ndarray, near: float, fine: bool = False) -> None:  # noqa: ARG002
        if self.menu is not None:
            # A machine that is too busy to draw counts as a headset that is not worn.
            self.choose("resume")
        target = {"positionMm": (MM * place).tolist(), "speedMmS": 400}
        reply = self._client.send_command("MoveTipTo", target, timeout=20)
        assert reply.ok, reply.error
        give_up = self.view.state["time"] + 4.0
        while np.linalg.norm(place - self.tip) > 0.002 and self.view.state["time"] < give_up:
            self.view.next_state()

    def press_on(self, label: str) -> None:
        """Record the fiducial under the tip."""
        self.steer_to(self.place_of(label), 0.002)
        kept = self.touched
        self.press("touch", lambda: self.touched > kept, f"touch {label}")

    def begin(self, task: str, page) -> None:
        """Go from the start menu into a task; the ID is typed on the keyboard."""
        if not self.menu or self.menu.name == "start":
            self.choose("train")
        while self.menu.name != "experiment":
            self.choose("skip" if self.menu.name == "introduction" else "next")
        self.focus("trainee")
        if not self.value("trainee"):
            page.keyboard.type("P7")
        self.until(lambda: self.value("trainee") == "P7", "the ID")
        self.choose(task)
        self.until(lambda: self.view.state["phase"] == "running", "the trial")

    def touch_all(self, most: int = 15) -> None:
        """Touch the points that are left, up to so many in all."""
        while self.touched < most:
            label = self.view.state["next"]
            self.approach(label, 0.004)
            self.press_on(label)

    def have_touched(self, most: int) -> None:
        """The same by commands, to be quick."""
        while (kept := self.touched) < most:
            label = self.view.state["next"]
            self.approach(label, 0.004)
            self.steer_to(self.place_of(label), 0.002)
            assert self._client.send_command("Capture", {}, timeout=20).ok
            self.until(lambda k=kept: self.touched > k, f"touch {label}")


def scored_trial(slicer: subprocess.Popen) -> dict:
    """Wait for the end of Slicer's side; return the results of its trial."""
    lines = slicer.communicate(timeout=PATIENCE_S)[0].splitlines()
    told = [json.loads(line) for line in lines]
    return next(line["results"] for line in told if line["event"] == "trial")
