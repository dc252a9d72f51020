"""The costs of a view: the stream, the scene, and the simulator's process while one watches."""

import tempfile
import time
from contextlib import ExitStack
from pathlib import Path

import numpy as np

from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.scene.scene_glb import scene_glb
from Testing.benchmarks.row import cpu_share, resident_mb, row
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient
from Testing.simulator.scene.glb_reader import Glb

CROWD = 4


def rows(quick: bool) -> list[dict]:
    """Return the rows `views.*` of the stream and the process, and `scene.*` of all six tasks."""
    seconds = 2.0 if quick else 10.0
    return [*_stream_rows(seconds), _crowd_row(seconds), *_scene_rows(quick)]


def _stream_rows(seconds: float) -> list[dict]:
    with tempfile.TemporaryDirectory() as folder:
        arguments = (Path(folder) / "records", "--view-port", "0")
        with (
            LoopThread() as thread,
            ViewedSimulator(*arguments) as simulator,
            ViewClient(thread, simulator.url, simulator.key) as view,
        ):
            view.join()
            view.next("scene")
            sizes, states = [], 0
            end = time.monotonic() + seconds
            while time.monotonic() < end:
                text = view.next_text()
                sizes.append(len(text.encode()))
                states += text.startswith('{"type":"state"')
            cpu = [cpu_share(simulator.pid, 0.5) for _ in range(int(seconds))]
            rss = resident_mb(simulator.pid)
    return [
        row("views.stream", [sum(sizes) / seconds / 1000], "kB/s"),
        row("views.states", [states / seconds], "1/s"),
        row("views.rss", [rss], "MB"),
        row("views.cpu", 100.0 * np.array(cpu), "%"),
    ]


def _crowd_row(seconds: float) -> dict:
    """Return what several views are sent together."""
    with tempfile.TemporaryDirectory() as folder, ExitStack() as stack:
        thread = stack.enter_context(LoopThread())
        arguments = (Path(folder) / "records", "--view-port", "0")
        simulator = stack.enter_context(ViewedSimulator(*arguments))
        joining = [ViewClient(thread, simulator.url, simulator.key) for _ in range(CROWD)]
        views = [stack.enter_context(view) for view in joining]
        for view in views:
            view.join()
            view.next("state")
        sizes = [0]
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            sizes += [len(view.next_text().encode()) for view in views]
    return row(f"views.stream to {CROWD}", [sum(sizes) / seconds / 1000], "kB/s")


def _scene_rows(quick: bool) -> list[dict]:
    setup = load_setup()
    times, contents = [], []
    for task in setup.scenario.tasks[: 2 if quick else None]:
        begin = time.perf_counter()
        contents.append(scene_glb(setup.scenario, setup.robot, task))
        times.append(time.perf_counter() - begin)
    parts = [Glb(content).primitives("world") for content in contents]
    triangles = [sum(len(part[2]) for part in primitives) for primitives in parts]
    return [
        row("scene.build", times, "s"),
        row("scene.size", [len(content) / 1e6 for content in contents], "MB"),
        row("scene.triangles", triangles, ""),
        row("scene.draw_calls", [len(primitives) for primitives in parts], ""),
    ]
