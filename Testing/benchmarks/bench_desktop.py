"""From the gamepad's stick to the picture in the window, and what the window does to the loop.

The window is 1920 × 1080 on a display in memory, so the processor draws: the worst case. It is
opened with its own settings, as a trainee would. Its pictures are also counted at 1280 × 720, and
`web.pictures` counts those of the page.
"""

import json
import math
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.igtl.client import Client
from rastrainer.protocol import PROTOCOL_VERSION, Phase
from rastrainer_simulator.desktop.app import TRIED_FRAMES
from Testing.benchmarks.row import row
from Testing.benchmarks.watched_loop import WatchedLoop
from Testing.end_to_end.lab import Lab
from Testing.end_to_end.window_process import WindowProcess, wait_until

SIZE, SMALL = (1920, 1080), (1280, 720)
SEED = 5
PUSH = 0.8
REST_S = (0.4, 0.6)
MIDDLE_M = 0.6
"""Above it the stick is pushed down, below it up."""
LOOK_S = 0.2
"""Time between two checks of the arm's position."""
TIMEOUT_S = 20.0
SETTLED_PICTURES = 2 * TRIED_FRAMES
"""Pictures of one quality in a row: by then the window has lowered it as far as it will."""


class Delay(NamedTuple):
    """From a push of the stick, s, until the stream and until a picture shows it."""

    streamed: float
    shown: float


class Swing(NamedTuple):
    """How punctual the loop was while the arm moved up and down, and for how long, s."""

    watched: WatchedLoop
    seconds: float


class Drawn(NamedTuple):
    """How many pictures a second a window has drawn, 1/s, and in which quality."""

    rate: float
    quality: str


def rows(quick: bool) -> list[dict]:
    """Return the rows `desktop.*`, and `loop.on_time.*` with and without the window.

    Beside each of these two is a loop that does nothing, at the same time on the same machine.
    """
    seconds, pushes = (5, 8) if quick else (15, 40)
    with (
        tempfile.TemporaryDirectory() as folder,
        Lab(Path(folder)) as lab,
        Client(port=lab.simulator.port) as slicer,
    ):
        _start_trial(lab, slicer)
        alone = _swing(lab, slicer, seconds)
        window = _open(lab, SIZE)
        _warm_up(lab, window)
        random = np.random.default_rng(SEED)
        delays = [_delay(lab, window, random) for _ in range(pushes)]
        beside, large = _count(lab, slicer, window, seconds)
        window.kill()
        window = _open(lab, SMALL)
        _resume(lab, slicer)
        _warm_up(lab, window)
        _, small = _count(lab, slicer, window, seconds)
    streamed, shown = 1e3 * np.array(delays).T
    return [
        row("desktop.stick to stream", streamed, "ms"),
        row("desktop.stick to picture", shown, "ms"),
        row(f"desktop.pictures 1920x1080 {large.quality}", [large.rate], "1/s"),
        row(f"desktop.pictures 1280x720 {small.quality}", [small.rate], "1/s"),
        _on_time_row("window", beside),
        _on_time_row("no window", alone),
    ]


def _open(lab: Lab, size: tuple[int, int]) -> WindowProcess:
    width, height = size
    return lab.open_window(f"window {width}", "--size", f"{width}x{height}")


def _warm_up(lab: Lab, window: WindowProcess) -> None:
    """Swing the arm until the quality has settled, and all that draws it is compiled."""
    while len(window.frames()) < SETTLED_PICTURES or len(set(_qualities(window))) > 1:
        _push(lab, _way(lab))
        time.sleep(LOOK_S)
    _push(lab, 0.0)


def _qualities(window: WindowProcess) -> list[str]:
    """Return the quality of each of the last pictures."""
    return [json.loads(line)["quality"] for line in window.frames()[-SETTLED_PICTURES:]]


def _count(lab: Lab, slicer: Client, window: WindowProcess, seconds: int) -> tuple[Swing, Drawn]:
    drawn = len(window.frames())
    swung = _swing(lab, slicer, seconds)
    rate = (len(window.frames()) - drawn) / swung.seconds
    assert lab.view.state["phase"] == Phase.RUNNING, "The arm did not move all the time."
    return swung, Drawn(rate, _qualities(window)[-1])


def _start_trial(lab: Lab, slicer: Client) -> None:
    hello = {"protocolVersion": PROTOCOL_VERSION, "client": "bench"}
    task = {"task": "task-1", "trainee": "bench", "seed": SEED}
    for name, arguments in ((CommandName.HELLO, hello), (CommandName.START_TASK, task)):
        reply = slicer.send_command(name, arguments, timeout=20)
        assert reply.ok, reply.error
    wait_until(lambda: lab.view.screen.menu is None, "the task")
    wait_until(lambda: lab.view.scene["fiducials"], "its scene")


def _resume(lab: Lab, slicer: Client) -> None:
    """Resume the trial, which is paused when the window that shows it is closed."""
    wait_until(lambda: lab.view.state["phase"] == Phase.PAUSED, "the pause")
    reply = slicer.send_command(CommandName.RESUME, {}, timeout=20)
    assert reply.ok, reply.error
    wait_until(lambda: lab.view.screen.menu is None, "the task")


def _delay(lab: Lab, window: WindowProcess, random: np.random.Generator) -> Delay:
    """Push the stick once; a picture shows it when the tip is a pixel away from where it was."""
    start = lab.view.pose("tool")[:3, 3]
    enough, known = _pixel(lab, start), len(window.frames())
    begin = time.monotonic()
    _push(lab, _way(lab))
    while np.linalg.norm(lab.view.pose("tool")[:3, 3] - start) < enough:
        lab.view.next_state()
        assert time.monotonic() < begin + TIMEOUT_S, "the arm has not moved"
    streamed, tick = time.monotonic(), lab.view.state["tick"]
    shown: list[float] = []

    def is_shown() -> bool:
        frames = [json.loads(line) for line in window.frames()[known:]]
        shown.extend(frame["shown"] for frame in frames if frame["tick"] >= tick)
        return bool(shown)

    wait_until(is_shown, "a picture of the moved arm")
    _push(lab, 0.0)
    # So that pushes fall anywhere between two ticks, two messages and two pictures.
    time.sleep(random.uniform(*REST_S))
    return Delay(streamed - begin, shown[0] - begin)


def _swing(lab: Lab, slicer: Client, seconds: int) -> Swing:
    with WatchedLoop(slicer) as watched:
        begin = time.monotonic()
        while time.monotonic() < begin + seconds:
            _push(lab, _way(lab))
            time.sleep(LOOK_S)
        _push(lab, 0.0)
        took = time.monotonic() - begin
    return Swing(watched, took)


def _push(lab: Lab, up: float) -> None:
    lab.simulator.move(righty=-up)


def _way(lab: Lab) -> float:
    return PUSH if lab.view.pose("tool")[2, 3] < MIDDLE_M else -PUSH


def _pixel(lab: Lab, place: np.ndarray) -> float:
    """Return how large a pixel is at a place, m."""
    camera = lab.view.scene["cameras"][lab.view.state["camera"]]
    distance = float(np.linalg.norm(place - camera["position"]))
    return 2.0 * distance * math.tan(math.radians(camera["viewAngleDeg"]) / 2.0) / SIZE[1]


def _on_time_row(name: str, swing: Swing) -> dict:
    """Return a row like `loop.on_time`: p99 is the share that 99 of 100 seconds exceed."""
    measured, bare = swing.watched.measured, swing.watched.bare
    others = {"success": measured.on_time, "n": measured.ticks, "worst": 1}
    return row(f"loop.on_time.{name}", measured.shares, "%", "bare loop", bare.shares, **others)
