"""A training place without a window: the simulator, a view that watches, and Slicer's side."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Mapping
from contextlib import ExitStack
from itertools import accumulate
from pathlib import Path

import numpy as np
from playwright.sync_api import Page

from rastrainer.igtl.client import Client
from rastrainer.json_records import camel_case
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.flow.session.chosen_trial import FIRST_ID
from Testing.end_to_end.onto_skin import lowered
from Testing.end_to_end.simulator_process import SERVES, SimulatorProcess, paired_key
from Testing.end_to_end.stream_trainee import StreamTrainee, WatchingView
from Testing.end_to_end.virtual_gamepad import SimulatorWithGamepad
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient
from Testing.web.chromium import wait_for

SLICER = (sys.executable, "-m", "rastrainer_headless.main")
TRAINEE = "P7"
PATIENCE_S = 300
WITHOUT_GRAPHICS = {"silent_s": 10, "lost_s": 20, "gone_s": 300}
"""Limits of views for a machine that draws a headset's pictures by its processor: seconds each."""
PATIENT = {"silent_s": 60, "lost_s": 600, "gone_s": 600}
"""A late browser, however busy the machine is, neither releases the input nor pauses the trial."""
SETTLED_STATES = 20
"""For how many states in a row a focus stays that no input moves: a third of a second."""
LEAVES = {"trial": "abort", "abort": "abort", "complete": "abort", "result": "menu"}
"""Which item of a menu leads toward the start."""


class Place:
    """One simulator and its clients; ended by the `with` statement.

    Attributes:
        simulator: the process; its `url` is where the page is, its `code` pairs a browser.
        view: a spectator.
        records: folder of the journals.
    """

    def __init__(
        self,
        folder: Path,
        *arguments: str,
        has_gamepad: bool = False,
        limits: Mapping[str, float] = PATIENT,
        **preferences: str,
    ):
        self._stack = ExitStack()
        self._folder = folder
        self.records = folder / "records"
        config = folder / "records-config"
        config.mkdir()
        preferences = {"order": "any", **preferences}
        (config / "preferences.json").write_text(json.dumps(preferences), encoding="utf-8")
        views = {camel_case(name): value for name, value in limits.items()}
        (config / "limits.json").write_text(json.dumps({"views": views}), encoding="utf-8")
        options = ["--view-port", "0", "--seed", "7", *arguments]
        if not has_gamepad:
            options.append("--no-gamepad")
        process = SimulatorWithGamepad if has_gamepad else SimulatorProcess
        self.simulator = self._stack.enter_context(process(self.records, *options))
        served = SERVES.search(self.simulator.next_line())
        self.simulator.url, self.simulator.code = served.groups()
        key = paired_key(*served.groups())
        thread = self._stack.enter_context(LoopThread())
        watcher = self._stack.enter_context(ViewClient(thread, self.simulator.url, key))
        self.view = WatchingView(watcher)

    def __enter__(self) -> Place:
        return self

    def __exit__(self, *_exception: object) -> None:
        self._stack.close()

    def trainee(self, hands: object) -> Trainee:
        """Return a trainee who does everything by hand."""
        return Trainee(self.view, hands)

    def carried_trainee(self, hands: object) -> CarriedTrainee:
        """Return a trainee who uses menus by hand and has the tip carried, to save time."""
        return CarriedTrainee(self.view, hands, self.client())

    def client(self) -> Client:
        """Return a client that may command the simulator."""
        client = self._stack.enter_context(Client(port=self.simulator.port))
        hello = {"protocolVersion": PROTOCOL_VERSION, "client": "carrier"}
        assert client.send_command("Hello", hello, timeout=60).ok
        return client

    def start_slicer(self) -> subprocess.Popen:
        """Start Slicer's side, which scores one trial and ends."""
        process = subprocess.Popen(
            [
                *(*SLICER, "--port", str(self.simulator.port), "--trials", "1"),
                *("--assets", str(asset_path())),
                *("--output", str(self._folder / "study")),
            ],
            stdout=subprocess.PIPE,
            text=True,
        )
        self._stack.callback(process.kill)
        return process

    def entries(self, kind: str) -> list[dict]:
        """Return the entries of a kind in the latest trial's journal, as far as written."""
        journal = max(self.records.glob("*.journal"), key=_begun)
        lines = journal.read_text(encoding="utf-8").rpartition("\n")[0].splitlines()
        return [entry for entry in map(json.loads, lines) if entry["kind"] == kind]


def _begun(journal: Path) -> str:
    """Return when a trial has begun, UTC; "" before its first line is written."""
    with journal.open(encoding="utf-8") as lines:
        header = lines.readline()
    return json.loads(header)["utc"] if header.endswith("\n") else ""


class Trainee(StreamTrainee):
    """Goes through the menus, and touches the points in their order."""

    # A press is seen in the next picture, however late: none is missed.
    again_s = 60.0

    def focus(self, item: str) -> None:
        """Move the focus to an item, and see that it stays there.

        A tapped key is held until the next picture: if that takes long, the focus moves on.
        """
        settled = 0
        while settled < SETTLED_STATES:
            super().focus(item)
            self.view.next_state()
            settled = settled + 1 if self.menu.focus == item else 0

    def go_home(self) -> None:
        """Go to the start menu from wherever the last trainee has stopped."""
        while self.menu_name != "start":
            before = self.menu
            if before is None:
                self.press("menu", lambda: self.menu is not None, "the menu")
            elif before.name in LEAVES:
                self.choose(LEAVES[before.name])
            else:
                self.press("back", lambda b=before: self.menu != b, f"before {before.name}")

    def go_to_experiment(self) -> None:
        """Go from wherever the last trainee has stopped to the choice of head and task."""
        self.go_home()
        self.choose("train")
        while self.menu_name != "experiment":
            self.choose("skip" if self.menu_name == "introduction" else "next")

    def play_to_result(self) -> None:
        """Touch all fiducials, register them, and read the score."""
        self.touch_all()
        self.register()
        self.until_menu("result")
        assert self.menu.facts[0].label == "Score"

    def begin(self, task: str, page: Page | None = None) -> None:
        """Go from the start menu into a task.

        The ID is typed on the page, or without one on the keyboard that the simulator shows.
        """
        self.go_to_experiment()
        if self.value("trainee") in ("", FIRST_ID):
            self.type_id(page)
        self.begin_task(task)
        self.until(lambda: self.view.state["phase"] == "running", "the trial")

    def type_id(self, page: Page | None) -> None:
        """Type the ID on the page, or without one on the keyboard that the simulator shows."""
        if page is not None:
            self.focus("trainee")
            page.wait_for_selector("#menu input:focus")
            for typed in accumulate(TRAINEE):
                page.keyboard.press(typed[-1])
                self.until(lambda typed=typed: self.value("trainee") == typed, "the ID")
                # A field forgets what the simulator took long to answer.
                wait_for(page, f"document.querySelector('#menu input:focus')?.value === '{typed}'")
            return
        self.choose("trainee")
        self.press("accept", lambda: self.menu.facts[0].value.startswith("A"), "the letter A")
        self.choose("done")

    def resume(self) -> None:
        """Resume a trial that was paused."""
        self.until_menu("trial")
        self.choose("resume")
        self.until(lambda: self.view.state["phase"] == "running", "the trial again")

    def touch_all(self, most: int = 15) -> None:
        """Touch the remaining points, up to so many in all."""
        while self.touched < most:
            label = self.view.state["next"]
            self.approach(label, 0.02)
            self.press_on(label)

    def register(self) -> None:
        """Have the touched points registered."""
        self.press("touch", lambda: self.menu is not None, "the choice")
        self.choose("register")


class OnPage:
    """Chooses items where the page shows them, for a trainee with a `page`."""

    page: Page

    def choose(self, item: str) -> None:
        """Choose an item of the open menu, which leads to another."""
        before = self.menu_name
        self.until_on_page()
        self.choose_on_page(item)
        self.until(lambda: self.menu_name != before, f"after {item}")

    def until_on_page(self) -> None:
        """Wait until the page shows the open menu: the previous one may have such an item, too."""
        selector = f"body[data-menu='{self.menu_name or ''}']"
        self.page.wait_for_selector(selector, state="attached")

    def choose_on_page(self, item: str) -> None:
        """Choose an item by the input device."""
        raise NotImplementedError


class CarriedTrainee(Trainee):
    """Is quick: commands carry the tip to its goals."""

    def __init__(self, view: WatchingView, hands: object, client: Client):
        super().__init__(view, hands)
        self.client = client

    def steer_to(self, place: np.ndarray, near: float, fine: bool = False) -> None:  # noqa: ARG002
        if self.menu is not None:
            # A machine that is too busy to draw counts as a headset that is not worn.
            self.choose("resume")
        target = {"positionMm": (MM_PER_M * place).tolist(), "speedMmS": 400}
        reply = self.client.send_command("MoveTipTo", target, timeout=60)
        assert reply.ok, reply.error
        give_up = self.view.state["timeS"] + 4.0
        while np.linalg.norm(place - self.tip) > 0.002 and self.view.state["timeS"] < give_up:
            self.view.next_state()

    def press_on(self, label: str) -> None:
        """Record the fiducial under the tip."""
        self.lower_onto(label)
        kept = self.touched
        self.press("touch", lambda: self.touched > kept, f"touch {label}")

    def lower_onto(self, label: str) -> bool:
        """Have the tip lowered onto a fiducial, until it is in contact."""
        place = self.place_of(label)
        self.steer_to(place, 0.002)
        below = lowered(MM_PER_M * place, MM_PER_M * self.head_center)
        target = {"positionMm": below, "speedMmS": 400}
        assert self.client.send_command("MoveTipTo", target, timeout=60).ok
        self.until(lambda: self.view.state["proximity"] == "contact", f"contact at {label}")
        return True

    def have_touched(self, most: int) -> None:
        """Have the points touched by commands, up to so many in all."""
        while (kept := self.touched) < most:
            label = self.view.state["next"]
            self.approach(label, 0.004)
            self.lower_onto(label)
            assert self.client.send_command("Capture", {}, timeout=60).ok
            self.until(lambda k=kept: self.touched > k, f"touch {label}")


def scored_trial(slicer: subprocess.Popen) -> dict:
    """Wait for the end of Slicer's side; return the results of its trial."""
    lines = slicer.communicate(timeout=PATIENCE_S)[0].splitlines()
    found = [json.loads(line) for line in lines]
    return next(line["results"] for line in found if line["event"] == "trial")
