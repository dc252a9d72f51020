"""How punctual the control loop of a running simulator is, by its heartbeat."""

import json
import threading
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise
from typing import Any

from rastrainer.igtl.client import Client
from rastrainer.protocol import DeviceName
from rastrainer_simulator.loop.timing import LoopStatistics
from Testing.benchmarks.row import row

TIMEOUT_S = 60.0


def health_of(beat: Mapping[str, Any]) -> LoopStatistics:
    """Return the loop statistics of a heartbeat."""
    return LoopStatistics(beat["ticks"], beat["lateTicks"], beat["skippedTicks"])


def next_health(client: Client) -> LoopStatistics:
    """Wait for the next heartbeat, which comes once a second."""
    known = client.latest.get(DeviceName.SIM_SERVER)
    beat = client.wait_for(DeviceName.SIM_SERVER, lambda new: new is not known, TIMEOUT_S)
    return health_of(json.loads(beat.content.message))


def on_time(earlier: LoopStatistics, later: LoopStatistics) -> float:
    """Return the share of ticks that were on time between heartbeats, 0…1; skipped are late."""
    ticks = later.ticks - earlier.ticks
    due = ticks + later.skipped - earlier.skipped
    return (ticks - later.late + earlier.late) / due if due else 1.0


class WatchedLoop:
    """Listens to a simulator's heartbeats while the `with` statement lasts."""

    def __init__(self, client: Client) -> None:
        self._client = client
        self._listener = ThreadPoolExecutor(1)
        self._is_over = threading.Event()
        self._healths: list[LoopStatistics] = []

    def __enter__(self) -> "WatchedLoop":
        self._heard = self._listener.submit(self._listen)
        return self

    def __exit__(self, *_exception: object) -> None:
        self._is_over.set()
        self._listener.shutdown()
        self._heard.result()

    def row(self, name: str) -> dict:
        """Return the share of ticks on time in each second, %; `success` is over all ticks."""
        shares = [100.0 * on_time(*two) for two in pairwise(self._healths)]
        first, last = self._healths[0], self._healths[-1]
        ticks, whole = last.ticks - first.ticks, on_time(first, last)
        return row(name, shares, "%", success=whole, n=ticks, worst=1)

    def _listen(self) -> None:
        self._healths.append(next_health(self._client))
        while not self._is_over.is_set():
            self._healths.append(next_health(self._client))
