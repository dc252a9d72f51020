"""A hundred OpenIGTLink clients and twenty views at once: what each still gets, and the loop."""

from __future__ import annotations

import asyncio
import json
import multiprocessing
import secrets
import socket
import struct
import tempfile
import time
from pathlib import Path

import aiohttp
import numpy as np

from rastrainer.igtl.content import Transform
from rastrainer.igtl.message import HEADER_BYTES, Message, pack
from Testing.benchmarks.process_cost import cpu_share, resident_mb
from Testing.benchmarks.row import row
from Testing.end_to_end.viewed_simulator import ViewedSimulator

CLIENTS, VIEWS = 100, 20
PROBE_PERIOD_S = 0.5
"""Between two probes of one client: all of them together send 200 in a second."""
SETTLE_S = 4.0
HOST = "127.0.0.1"
STREAM = "rastrainer.views.1"
HELLO = {"type": "hello", "kind": "page", "device": "", "refreshHz": 60}


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
            target=_crowd,
            args=(simulator.port, simulator.view_port, key, seconds, results),
        )
        crowd.start()
        time.sleep(SETTLE_S)
        cpu = [cpu_share(simulator.pid, 0.5) for _ in range(int(seconds))]
        rss = resident_mb(simulator.pid)
        told = results.get(timeout=60.0 + seconds)
        crowd.join()
    return [
        row("crowd.echo", 1e3 * np.array(told["echoes"]), "ms"),
        row("crowd.slowest_client", 1e3 * np.array(told["client_p99"]), "ms"),
        row("crowd.tool_tip", 1e3 * np.array(told["tool_tips"]), "ms"),
        row("crowd.view", 1e3 * np.array(told["states"]), "ms"),
        row("crowd.on_time", [told["on_time"]], "%"),
        row("crowd.cpu", 100.0 * np.array(cpu), "%"),
        row("crowd.rss", [rss], "MB"),
    ]


def _crowd(port: int, view_port: int, key: str, seconds: float, results) -> None:
    results.put(asyncio.run(_gather(port, view_port, key, seconds)))


async def _gather(port: int, view_port: int, key: str, seconds: float) -> dict:
    """Return every interval and delay, in s, of all clients and views, and the loop's share."""
    loop = asyncio.get_running_loop()
    clients = []
    for number in range(CLIENTS):
        _transport, client = await loop.create_connection(lambda n=number: _Client(n), HOST, port)
        clients.append(client)
    async with aiohttp.ClientSession(headers={"Authorization": f"Bearer {key}"}) as session:
        views = [_View() for _ in range(VIEWS)]
        url = f"http://{HOST}:{view_port}/stream"
        watching = [asyncio.create_task(view.watch(session, url)) for view in views]
        await asyncio.sleep(SETTLE_S)
        before = clients[0].beat
        for each in (*clients, *views):
            each.begin()
        await asyncio.gather(*(client.probe(seconds) for client in clients))
        after = clients[0].beat
        for task in watching:
            task.cancel()
    return {
        "echoes": [delay for client in clients for delay in client.echoes],
        "client_p99": [float(np.percentile(client.echoes, 99)) for client in clients],
        "tool_tips": [interval for client in clients for interval in client.intervals],
        "states": [interval for view in views for interval in view.intervals],
        "on_time": _on_time(before, after),
    }


def _on_time(before: dict, after: dict) -> float:
    ticks = after["ticks"] - before["ticks"]
    skipped = after["skippedTicks"] - before["skippedTicks"]
    late = after["lateTicks"] - before["lateTicks"]
    return 100.0 * (ticks - late) / (ticks + skipped)


class _Client(asyncio.Protocol):
    """Reads all it is sent, looking at no more than a fast client would."""

    def __init__(self, number: int) -> None:
        probe = Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, number))
        self._probe = pack(Message("Probe", probe))
        self._buffer = bytearray()
        self._sent = self._tip = 0.0
        self.echoes: list[float] = []
        self.intervals: list[float] = []
        self.beat: dict = {}
        self._number = number

    def connection_made(self, transport) -> None:
        self._transport = transport
        transport.get_extra_info("socket").setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def begin(self) -> None:
        self.intervals.clear()

    async def probe(self, seconds: float) -> None:
        """Send a probe now and then; not all clients at the same moment."""
        end = time.perf_counter() + seconds
        await asyncio.sleep(PROBE_PERIOD_S * self._number / CLIENTS)
        while time.perf_counter() < end:
            self._sent = time.perf_counter()
            self._transport.write(self._probe)
            await asyncio.sleep(PROBE_PERIOD_S)

    def data_received(self, data: bytes) -> None:
        now = time.perf_counter()
        self._buffer += data
        start, size = 0, len(self._buffer)
        while size - start >= HEADER_BYTES:
            end = start + HEADER_BYTES + struct.unpack_from(">Q", self._buffer, start + 42)[0]
            if end > size:
                break
            self._take(bytes(self._buffer[start + 14 : start + 34]), start, end, now)
            start = end
        del self._buffer[:start]

    def _take(self, field: bytes, start: int, end: int, now: float) -> None:
        name = field.rstrip(b"\0")
        if name == b"Probe":
            self.echoes.append(now - self._sent)
        elif name == b"ToolTipToWorld":
            self.intervals += [now - self._tip] if self._tip else []
            self._tip = now
        elif name == b"SimServer":
            body = bytes(self._buffer[start + HEADER_BYTES : end])
            self.beat = json.loads(body[body.index(b"{") : body.rindex(b"}") + 1])


class _View:
    """Watches the stream and notes when states come."""

    def __init__(self) -> None:
        self.intervals: list[float] = []
        self._last = 0.0

    def begin(self) -> None:
        self.intervals.clear()

    async def watch(self, session: aiohttp.ClientSession, url: str) -> None:
        async with session.ws_connect(url, protocols=[STREAM]) as stream:
            await stream.send_json(HELLO)
            async for message in stream:
                if message.data.startswith('{"type":"state"'):
                    now = time.perf_counter()
                    self.intervals += [now - self._last] if self._last else []
                    self._last = now
