"""The delay from the gamepad's stick to the picture in the window, and the window's effect on the
loop.

The window is on a display in memory, so the processor draws: the worst case. It is opened as
`rastrainer simulator --desktop` opens it. Pictures are counted while the arm moves.
"""

from __future__ import annotations

import math
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION, Phase
from Testing.benchmarks.loop_health import WatchedLoop
from Testing.benchmarks.row import row
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.window_process import WindowProcess, wait_until

LARGE = (1920, 1080)
SEED = 5
PUSH = 0.8
REST_S = (0.4, 0.6)
MIDDLE_M = 0.6
"""The stick is pushed down above it, and up below it."""
LOOK_S = 0.2
"""Time between two checks of the arm's position."""
TIMEOUT_S = 20.0
SETTLED_PICTURES = 40
"""Everything that draws is compiled by then."""


class Delay(NamedTuple):
    """The time from a push of the stick until the stream and until a picture shows it, s."""

    streamed: float
    shown: float


def rows(quick: bool) -> list[dict]:
    """Return the rows `desktop.*`, and `loop.on_time.*` with and without the window."""
    seconds, pushes = (5, 8) if quick else (15, 40)
    with (
        tempfile.TemporaryDirectory() as folder,
        Lab(Path(folder)) as lab,
        Client(port=lab.simulator.port) as slicer,
    ):
        _start_trial(lab, slicer)
        alone = _swing(lab, slicer, seconds)
        window = lab.open_window("window", LARGE)
        _warm_up(lab, window)
        random = np.random.default_rng(SEED)
        delays = [_delay(lab, window, random) for _ in range(pushes)]
        known, begin = len(window.pictures()), time.monotonic()
        beside = _swing(lab, slicer, seconds)
        drawn = (len(window.pictures()) - known) / (time.monotonic() - begin)
        assert lab.view.state["phase"] == Phase.RUNNING, "The arm did not move all the time."
    streamed, shown = 1e3 * np.array(delays).T
    return [
        row("desktop.stick to stream", streamed, "ms"),
        row("desktop.stick to picture", shown, "ms"),
        row("desktop.pictures {}x{}".format(*LARGE), [drawn], "1/s"),
        beside.row("loop.on_time.window"),
        alone.row("loop.on_time.no window"),
    ]


def _warm_up(lab: Lab, window: WindowProcess) -> None:
    """Swing the arm until all that draws it is compiled."""
    while len(window.pictures()) < SETTLED_PICTURES:
        _push(lab, _way(lab))
        time.sleep(LOOK_S)
    _push(lab, 0.0)


def _start_trial(lab: Lab, slicer: Client) -> None:
    hello = {"protocolVersion": PROTOCOL_VERSION, "client": "bench"}
    task = {"task": "task-1", "trainee": "bench", "seed": SEED}
    for name, arguments in ((CommandName.HELLO, hello), (CommandName.START_TASK, task)):
        reply = slicer.send_command(name, arguments, timeout=20)
        assert reply.ok, reply.error
    wait_until(lambda: lab.view.screen.menu is None, "the task")
    wait_until(lambda: lab.view.scene["fiducials"], "its scene")


def _delay(lab: Lab, window: WindowProcess, random: np.random.Generator) -> Delay:
    """Push the stick once; a picture shows it when the tip is a pixel away from where it was."""
    start = lab.view.pose("tool")[:3, 3]
    enough, known = _pixel(lab, start), len(window.pictures())
    begin, begin_utc = time.monotonic(), time.time()
    _push(lab, _way(lab))
    while np.linalg.norm(lab.view.pose("tool")[:3, 3] - start) < enough:
        lab.view.next_state()
        assert time.monotonic() < begin + TIMEOUT_S, f"the arm has not moved: {lab.view.screen}"
    streamed, tick = time.monotonic(), lab.view.state["tick"]
    shown: list[float] = []

    def is_shown() -> bool:
        pictures = window.pictures()[known:]
        shown.extend(picture["shown"] for picture in pictures if picture["tick"] >= tick)
        return bool(shown)

    wait_until(is_shown, "a picture of the moved arm")
    _push(lab, 0.0)
    # So that pushes fall anywhere between two ticks, two messages and two pictures.
    time.sleep(random.uniform(*REST_S))
    return Delay(streamed - begin, shown[0] - begin_utc)


def _swing(lab: Lab, slicer: Client, seconds: int) -> WatchedLoop:
    with WatchedLoop(slicer) as watched:
        begin = time.monotonic()
        while time.monotonic() < begin + seconds:
            _push(lab, _way(lab))
            time.sleep(LOOK_S)
        _push(lab, 0.0)
    return watched


def _push(lab: Lab, up: float) -> None:
    lab.simulator.move(righty=-up)


def _way(lab: Lab) -> float:
    return PUSH if lab.view.pose("tool")[2, 3] < MIDDLE_M else -PUSH


def _pixel(lab: Lab, place: np.ndarray) -> float:
    """Return how large a pixel is at a place, m."""
    camera = lab.view.scene["cameras"][lab.view.state["camera"]]
    distance = float(np.linalg.norm(place - camera["position"]))
    return 2.0 * distance * math.tan(math.radians(camera["viewAngleDeg"]) / 2.0) / LARGE[1]
