"""A hundred OpenIGTLink clients and twenty views at once, and what each still gets."""

import asyncio
import json
import socket
import struct
import time
from dataclasses import dataclass

import aiohttp

from rastrainer.commands import CommandName
from rastrainer.igtl.content import Command, Transform
from rastrainer.igtl.message import HEADER_BYTES, Message, pack
from rastrainer.protocol import PROTOCOL_VERSION

CLIENTS, VIEWS = 100, 20
PROBE_PERIOD_S = 0.5
"""The pause between two probes of one client: all of them together send 200 in a second."""
SETTLE_S = 4.0
TIMEOUT_S = 30.0
"""For the echoes of the last probes."""
HOST = "127.0.0.1"
STREAM = "rastrainer.views.1"
HELLO = {"type": "hello", "kind": "page", "device": "", "refreshHz": 60}
NUMBER_AT = HEADER_BYTES + 12 + 44
"""The last of a transform's twelve numbers, behind the extended header of version 2."""


@dataclass(frozen=True)
class Served:
    """The service of a crowd; times in s.

    Attributes:
        echoes: of each client, the delay of each probe that came back.
        lost: probes that never came back.
        tool_tips: of each client, the intervals between two poses of the tool.
        states: of each view, the intervals between two states.
        dropped: clients and views whose connection was ended.
    """

    echoes: list[list[float]]
    lost: int
    tool_tips: list[list[float]]
    states: list[list[float]]
    dropped: int


def serve_crowd(
    port: int,
    view_port: int,
    key: str,
    seconds: float,
    results,
    clients: int = CLIENTS,
    views: int = VIEWS,
) -> None:
    """Put what a crowd gets of a simulator in so many seconds into a queue, as `Served`."""
    results.put(asyncio.run(_serve(port, view_port, key, seconds, clients, views)))


async def _serve(
    port: int, view_port: int, key: str, seconds: float, count: int, view_count: int
) -> Served:
    loop = asyncio.get_running_loop()
    clients = []
    for number in range(count):
        _transport, client = await loop.create_connection(lambda n=number: _Client(n), HOST, port)
        clients.append(client)
    async with aiohttp.ClientSession(headers={"Authorization": f"Bearer {key}"}) as session:
        views = [_View() for _ in range(view_count)]
        url = f"http://{HOST}:{view_port}/stream"
        watching = [asyncio.create_task(view.watch(session, url)) for view in views]
        await asyncio.sleep(SETTLE_S)
        for each in (*clients, *views):
            each.intervals.clear()
        await asyncio.gather(*(client.probe(seconds) for client in clients))
        dropped = sum(client.is_dropped for client in clients)
        dropped += sum(task.done() for task in watching)
        for task in watching:
            task.cancel()
    return Served(
        echoes=[client.echoes for client in clients],
        lost=sum(len(client.sent) for client in clients),
        tool_tips=[client.intervals for client in clients],
        states=[view.intervals for view in views],
        dropped=dropped,
    )


class _Client(asyncio.Protocol):
    """Reads all it is sent, parsing no more than a fast client would."""

    def __init__(self, number: int) -> None:
        self._buffer = bytearray()
        self._tip = 0.0
        self._probes = 0
        self._number = number
        self.sent: dict[int, float] = {}
        self.echoes: list[float] = []
        self.intervals: list[float] = []
        self.is_dropped = False

    def connection_made(self, transport) -> None:
        self._transport = transport
        transport.get_extra_info("socket").setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        hello = {"protocolVersion": PROTOCOL_VERSION, "client": "crowd", "steady": True}
        transport.write(pack(Message("command", Command(1, CommandName.HELLO, json.dumps(hello)))))

    def connection_lost(self, _error) -> None:
        self.is_dropped = True

    async def probe(self, seconds: float) -> None:
        """Send a probe now and then, not all clients at the same moment, and wait for the last."""
        end = time.perf_counter() + seconds
        await asyncio.sleep(PROBE_PERIOD_S * self._number / CLIENTS)
        while time.perf_counter() < end:
            self._probes += 1
            probe = Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, self._probes))
            self.sent[self._probes] = time.perf_counter()
            self._transport.write(pack(Message("Probe", probe)))
            await asyncio.sleep(PROBE_PERIOD_S)
        give_up = time.perf_counter() + TIMEOUT_S
        while self.sent and time.perf_counter() < give_up:
            await asyncio.sleep(0.05)

    def data_received(self, data: bytes) -> None:
        now = time.perf_counter()
        self._buffer += data
        start, size = 0, len(self._buffer)
        while size - start >= HEADER_BYTES:
            end = start + HEADER_BYTES + struct.unpack_from(">Q", self._buffer, start + 42)[0]
            if end > size:
                break
            self._take(bytes(self._buffer[start + 14 : start + 34]), start, now)
            start = end
        del self._buffer[:start]

    def _take(self, field: bytes, start: int, now: float) -> None:
        name = field.rstrip(b"\0")
        if name == b"Probe":
            number = round(struct.unpack_from(">f", self._buffer, start + NUMBER_AT)[0])
            self.echoes.append(now - self.sent.pop(number))
        elif name == b"ToolTipToWorld":
            self.intervals += [now - self._tip] if self._tip else []
            self._tip = now


class _View:
    """Watches the stream and notes when states come."""

    def __init__(self) -> None:
        self.intervals: list[float] = []
        self._last = 0.0

    async def watch(self, session: aiohttp.ClientSession, url: str) -> None:
        async with session.ws_connect(url, protocols=[STREAM]) as stream:
            await stream.send_json(HELLO)
            async for message in stream:
                if message.data.startswith('{"type":"state"'):
                    now = time.perf_counter()
                    self.intervals += [now - self._last] if self._last else []
                    self._last = now
