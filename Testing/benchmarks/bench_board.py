"""A teacher's board with 30 recorded and two real seats, watched in two browsers."""

from __future__ import annotations

import multiprocessing
import re
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright

from rastrainer.commands import CommandName
from rastrainer.igtl.client import Client
from Testing.benchmarks.recorded_seats import recorded, repeat
from Testing.benchmarks.row import cpu_share, row
from Testing.benchmarks.watched_loop import WatchedLoop
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import answered
from Testing.web.chromium import launch

RECORDED, REAL, BROWSERS = 30, 2, 2
COMMAND = (sys.executable, "-m", "rastrainer_simulator.cli.main", "board", "--port", "0")
LINE = re.compile(r"RASTrainer board is on (\S+), pairing code (\d{6});")
JOG_S = 0.05
TURN_S = 1.0
SPEED_MM_S = 40.0
NOTE_TILES = """
window.seen = [];
const setter = Object.getOwnPropertyDescriptor(WebSocket.prototype, "onmessage").set;
Object.defineProperty(WebSocket.prototype, "onmessage", { set(handle) {
  setter.call(this, (event) => {
    handle(event);
    const seats = JSON.parse(event.data).seats;
    requestAnimationFrame(() => {
      const now = Date.now() / 1000;
      for (const { name, seat } of seats)
        if (seat !== null) window.seen.push([name, seat.rejected, now]);
    });
  });
} });
"""


def rows(quick: bool) -> list[dict]:
    """Return how far behind tiles are, the real seats' loops, and what the board costs."""
    seconds = 5.0 if quick else 30.0
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        thread = stack.enter_context(LoopThread())
        seats = [
            stack.enter_context(ViewedSimulator(Path(folder) / f"records {n}", "--view-port", "0"))
            for n in range(REAL)
        ]
        slicers = [stack.enter_context(Client(port=seat.port)) for seat in seats]
        for number, slicer in enumerate(slicers):
            stack.enter_context(_moving(slicer, f"P{number}"))
        recording = thread.run(recorded(seats[0], 10.0))
        recordings = stack.enter_context(_repeated(recording))
        board = stack.enter_context(_board(Path(folder) / "teacher"))
        addresses = {f"recorded {n}": (port, "000000") for n, port in enumerate(recordings.ports)}
        for number, seat in enumerate(seats):
            addresses[f"real {number}"] = (seat.view_port, seat.code)
        thread.run(_add_all(board, addresses))
        pages = stack.enter_context(_browsers(board))
        with WatchedLoop(slicers[0]) as first, WatchedLoop(slicers[1]) as second:
            cpu = cpu_share(board.pid, seconds)
            for page in pages:
                page.evaluate("1")
        sent = recordings.sent()
        behind = [delay for page in pages for delay in _delays(page.evaluate("seen"), sent)]
    name = f"board.tile of {RECORDED + REAL}"
    return [
        row(name, 1000.0 * np.array(behind), "ms"),
        row("board.cpu", [100.0 * cpu], "%"),
        *(_loop_row(number, watched) for number, watched in enumerate((first, second))),
    ]


def _loop_row(number: int, watched: WatchedLoop) -> dict:
    measured, bare = watched.measured, watched.bare
    return row(
        f"loop.on_time.seat {number}",
        measured.shares,
        "%",
        "bare loop",
        bare.shares,
        success=measured.on_time,
        n=measured.ticks,
        worst=1,
    )


def _delays(seen: list, sent: dict) -> list[float]:
    """Return for each message of a recorded seat that was shown how long after sending, s."""
    first: dict[tuple[int, int], float] = {}
    for name, number, when in seen:
        if name.startswith("recorded "):
            first.setdefault((int(name.removeprefix("recorded ")), number), when)
    return [when - sent[key] for key, when in first.items() if key in sent]


class _Recordings:
    def __init__(self, recording) -> None:
        context = multiprocessing.get_context("spawn")
        self._pipe, theirs = context.Pipe()
        arguments = (RECORDED, recording, theirs)
        self.process = context.Process(target=repeat, args=arguments, daemon=True)
        self.process.start()
        self.ports = self._pipe.recv()

    def sent(self) -> dict:
        """End them, and return when each message was sent."""
        self._pipe.send("stop")
        return self._pipe.recv()


@contextmanager
def _repeated(recording):
    recordings = _Recordings(recording)
    try:
        yield recordings
    finally:
        recordings.process.kill()
        recordings.process.join()


@contextmanager
def _moving(slicer: Client, trainee: str):
    """Have a trial run in which the arm goes up and down."""
    start = {"task": "task-1", "trainee": trainee, "mode": "desktop"}
    slicer.send_command(CommandName.START_TASK, start)
    is_over = threading.Event()

    def move() -> None:
        begin = time.monotonic()
        while not is_over.wait(JOG_S):
            up = SPEED_MM_S if (time.monotonic() - begin) // TURN_S % 2 else -SPEED_MM_S
            jog = {"velocityMmS": [0, 0, up], "durationS": 2 * JOG_S}
            slicer.send_command(CommandName.JOG, jog)

    thread = threading.Thread(target=move)
    thread.start()
    try:
        yield
    finally:
        is_over.set()
        thread.join()


class _Board:
    def __init__(self, config: Path) -> None:
        self.process = subprocess.Popen(
            [*COMMAND, "--config", str(config)], stdout=subprocess.PIPE, text=True
        )
        found = LINE.match(self.process.stdout.readline())
        self.url, self.code = found.groups()
        self.pid = self.process.pid


@contextmanager
def _board(config: Path):
    board = _Board(config)
    try:
        yield board
    finally:
        board.process.kill()
        board.process.wait()


async def _add_all(board: _Board, addresses: dict[str, tuple[int, str]]) -> None:
    """Pair the board with all simulators, as a teacher does one after the other."""
    _status, _headers, answer = await answered(
        board.url, "/pair", "POST", json={"code": board.code}
    )
    key = answer.decode().split('"')[3]
    headers = {"Authorization": f"Bearer {key}"}
    for name, (port, code) in addresses.items():
        body = {"name": name, "address": f"http://127.0.0.1:{port}", "code": code}
        status, _headers, reason = await answered(
            board.url, "/seats", "POST", headers=headers, json=body
        )
        assert status == 200, reason


@contextmanager
def _browsers(board: _Board):
    with sync_playwright() as driver:
        browser = launch(driver)
        pages = []
        for _ in range(BROWSERS):
            page = browser.new_context(viewport={"width": 1920, "height": 1080}).new_page()
            page.add_init_script(NOTE_TILES)
            page.goto(f"{board.url}/#code={board.code}")
            page.wait_for_selector(f"#seats > li:nth-child({RECORDED + REAL})")
            pages.append(page)
        yield pages
        browser.close()
