"""From a stick to the picture: the window in software rendering, and what it does to the loop."""

from __future__ import annotations

import json
import tempfile
import threading
import time
from pathlib import Path

import numpy as np

from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.window_process import WindowProcess, wait_until
from Testing.simulator.igtl.servers import LoopThread
from Testing.simulator.view_server.served import ViewClient

SIZE = ("--size", "1920x1080", "--quality", "low")
ALIVE_S = 0.1
MOVED_M = 1e-5
REST_S = 0.6


def rows(quick: bool) -> list[dict]:
    """Return `desktop.stick-picture`, `desktop.frames`, and `loop.on-time` with and without it."""
    seconds = 3.0 if quick else 15.0
    with tempfile.TemporaryDirectory() as folder, Lab(Path(folder)) as lab:
        _start_trial(lab)
        thread = LoopThread()
        try:
            with ViewClient(thread, lab.url, lab.key) as client:
                sticks = Sticks(client)
                alone = _on_time(lab, sticks, seconds)
                window = lab.open_window("window", *SIZE)
                delays = [_delay(lab, sticks, window) for _ in range(8 if quick else 40)]
                before, begin = len(window.frames()), time.monotonic()
                beside = _on_time(lab, sticks, seconds)
                rate = (len(window.frames()) - before) / (time.monotonic() - begin)
                sticks.close()
        finally:
            thread.stop()
    return [
        _row("desktop.stick-picture", np.array(delays) * 1e3, "ms"),
        _row("desktop.frames", np.array([rate]), "1/s"),
        _row("loop.on-time, window", np.array([beside]), "%", "no window", np.array([alone])),
    ]


class Sticks:
    """The sticks of a view's controllers, held as long as they are pushed."""

    def __init__(self, client: ViewClient):
        self._client = client
        self._up = 0.0
        self._is_open = True
        client.join(kind="headset", device="bench")
        self._thread = threading.Thread(target=self._keep_alive, daemon=True)
        self._thread.start()

    def push(self, up: float) -> None:
        """Push up (1) or down (−1), or let go (0)."""
        self._up = up
        self._send()

    def close(self) -> None:
        """Let go for good."""
        self._is_open = False
        self._thread.join()

    def _send(self) -> None:
        self._client.send(
            {"type": "sticks", "translation": [0, 0, self._up], "rotation": [0, 0], "fine": False}
        )

    def _keep_alive(self) -> None:
        while self._is_open:
            if self._up:
                self._client.send({"type": "alive"})
            time.sleep(ALIVE_S)


def _start_trial(lab: Lab) -> None:
    with Client(port=lab.simulator.port) as client:
        hello = {"protocolVersion": PROTOCOL_VERSION, "client": "bench"}
        for name, arguments in (
            ("Hello", hello),
            ("StartTask", {"task": "task-1", "trainee": "bench", "seed": 5}),
        ):
            reply = client.send_command(name, arguments, timeout=20)
            assert reply.ok, reply.error
    wait_until(lambda: lab.view.screen.menu is None, "the task")


def _delay(lab: Lab, sticks: Sticks, window: WindowProcess) -> float:
    """Return the seconds from a push of the stick to the first picture of the moved arm."""
    height = lab.view.pose("tool")[2, 3]
    known = len(window.frames())
    begin = time.monotonic()
    sticks.push(0.5 if height < 0.6 else -0.5)
    moved = []

    def has_moved() -> bool:
        state = lab.view.state
        if abs(lab.view.pose("tool")[2, 3] - height) > MOVED_M:
            moved.append(state["tick"])
        return bool(moved)

    wait_until(has_moved, "a move of the arm")
    shown = []

    def is_shown() -> bool:
        frames = [json.loads(line) for line in window.frames()[known:]]
        shown.extend(frame["shown"] for frame in frames if frame["tick"] >= moved[0])
        return bool(shown)

    wait_until(is_shown, "a picture of the moved arm")
    sticks.push(0.0)
    time.sleep(REST_S)
    return shown[0] - begin


def _on_time(lab: Lab, sticks: Sticks, seconds: float) -> float:
    """Return the share of ticks, in percent, that were on time while the arm moved."""
    first = lab.view.state
    end = time.monotonic() + seconds
    way = 0.3
    while time.monotonic() < end:
        sticks.push(way)
        time.sleep(0.5)
        way = -way
    sticks.push(0.0)
    last = lab.view.state
    ticks = last["tick"] - first["tick"]
    return 100.0 * (1.0 - (last["delayed"] - first["delayed"]) / ticks)


def _row(name: str, values: np.ndarray, unit: str, peer: str | None = None, peers=None) -> dict:
    return {
        "name": name,
        "median": float(np.median(values)),
        "p99": float(np.percentile(values, 99)),
        "unit": unit,
        "peer": peer,
        "peer_median": None if peers is None else float(np.median(peers)),
        "peer_p99": None if peers is None else float(np.percentile(peers, 99)),
        "success": None,
        "n": len(values),
    }
