"""How punctual a running simulator is while something is done to it, beside a bare loop."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor

from rastrainer.igtl.client import Client
from rastrainer_simulator.loop.loop_statistics import LoopStatistics
from Testing.benchmarks.bare_loop import BareLoop
from Testing.benchmarks.loop_health import Punctuality, next_health, punctuality, undisturbed


class WatchedLoop:
    """Listens to a simulator's heartbeats while the `with` statement lasts.

    After it, of what was told from the first heartbeat to the last:

    Attributes:
        told: how punctual the simulator's loop was.
        bare: the same of a loop on each processor that does nothing: none can do better there and
            then.
        undisturbed: of the simulator's, in those seconds in which none of these was late; None
            where there was no such second.
    """

    def __init__(self, client: Client) -> None:
        self.told: Punctuality | None = None
        self.bare: Punctuality | None = None
        self.undisturbed: Punctuality | None = None
        self._client = client
        self._bare_loop = BareLoop()
        self._listener = ThreadPoolExecutor(1)
        self._is_over = threading.Event()

    def __enter__(self) -> WatchedLoop:
        self._bare_loop.__enter__()
        self._heard = self._listener.submit(self._listen)
        return self

    def __exit__(self, *exception: object) -> None:
        self._is_over.set()
        self._listener.shutdown()
        self._bare_loop.__exit__(*exception)
        healths = self._heard.result()
        self.told = punctuality([health for _, health in healths])
        self.bare = self._bare_loop.punctuality
        self.undisturbed = undisturbed(healths, self._bare_loop.was_never_late)

    def _listen(self) -> list[tuple[float, LoopStatistics]]:
        healths = [self._next_beat()]
        while not self._is_over.is_set():
            healths.append(self._next_beat())
        return healths

    def _next_beat(self) -> tuple[float, LoopStatistics]:
        health = next_health(self._client)
        return time.monotonic(), health
