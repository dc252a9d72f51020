"""A hundred OpenIGTLink clients and twenty views at once: what each still gets, and the loop."""

from __future__ import annotations

import multiprocessing
import secrets
import tempfile
import time
from pathlib import Path

import numpy as np

from Testing.benchmarks.crowd import SETTLE_S, Served, serve_crowd
from Testing.benchmarks.process_cost import cpu_share, resident_mb
from Testing.benchmarks.row import row
from Testing.end_to_end.simulator_process import ViewedSimulator


def rows(quick: bool) -> list[dict]:
    """Return the rows `crowd.*`: echoes, each client's p99, intervals of poses and states, loop."""
    seconds = 5.0 if quick else 20.0
    key = secrets.token_urlsafe()
    with (
        tempfile.TemporaryDirectory() as folder,
        ViewedSimulator(Path(folder) / "records", "--view-port", "0", key=key) as simulator,
    ):
        begin = multiprocessing.get_context("spawn")
        results = begin.Queue()
        # The crowd is a process of its own: it must not wait for its own measurement.
        crowd = begin.Process(
            target=serve_crowd,
            args=(simulator.port, simulator.view_port, key, seconds, results),
        )
        crowd.start()
        time.sleep(SETTLE_S)
        cpu = [cpu_share(simulator.pid, 0.5) for _ in range(int(seconds))]
        rss = resident_mb(simulator.pid)
        served: Served = results.get(timeout=60.0 + seconds)
        crowd.join()
    echoes = np.concatenate(served.echoes)
    client_p99 = [float(np.percentile(each, 99)) for each in served.echoes]
    answered = len(echoes) / (len(echoes) + served.lost)
    return [
        row("crowd.echo", 1e3 * echoes, "ms", success=answered),
        row("crowd.slowest_client", 1e3 * np.array(client_p99), "ms"),
        row("crowd.tool_tip", 1e3 * np.concatenate(served.tool_tips), "ms"),
        row("crowd.view", 1e3 * np.concatenate(served.states), "ms"),
        row("crowd.on_time", [100.0 * served.on_time], "%"),
        row("crowd.cpu", 100.0 * np.array(cpu), "%"),
        row("crowd.rss", [rss], "MB"),
    ]
