"""A hundred OpenIGTLink clients and twenty views at once, and what each still gets."""

import asyncio
import json
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


@dataclass(frozen=True)
class Served:
    """The service of a crowd.

    Attributes:
        echoes, poses: of each client, how many probes came back, and poses of the tool came.
        states: of each view, how many states came.
        lost: probes that never came back.
        dropped: clients and views whose connection was ended.
    """

    echoes: list[int]
    poses: list[int]
    states: list[int]
    lost: int
    dropped: int


def serve_crowd(address: tuple[int, int, str], seconds: float, results, clients: int, views: int):
    """Put what a crowd gets of a simulator in so many seconds into a queue, as `Served`.

    The address is the port of OpenIGTLink, and the port and a key of views.
    """
    results.put(asyncio.run(_serve(*address, seconds, clients, views)))


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
        for client in clients:
            client.poses = 0
        for view in views:
            view.states = 0
        await asyncio.gather(*(client.probe(seconds) for client in clients))
        dropped = sum(client.is_dropped for client in clients)
        dropped += sum(task.done() for task in watching)
        for task in watching:
            task.cancel()
    return Served(
        echoes=[client.echoes for client in clients],
        poses=[client.poses for client in clients],
        states=[view.states for view in views],
        lost=sum(client.sent - client.echoes for client in clients),
        dropped=dropped,
    )


class _Client(asyncio.Protocol):
    """Reads all it is sent, parsing no more than a fast client would."""

    def __init__(self, number: int) -> None:
        self._buffer, self._number = bytearray(), number
        self.sent = self.echoes = self.poses = 0
        self.is_dropped = False

    def connection_made(self, transport) -> None:
        self._transport = transport
        hello = {"protocolVersion": PROTOCOL_VERSION, "client": "crowd", "steady": True}
        transport.write(pack(Message("command", Command(1, CommandName.HELLO, json.dumps(hello)))))

    def connection_lost(self, _error) -> None:
        self.is_dropped = True

    async def probe(self, seconds: float) -> None:
        """Send a probe now and then, not all clients at the same moment, and wait for the last."""
        end = time.perf_counter() + seconds
        await asyncio.sleep(PROBE_PERIOD_S * self._number / CLIENTS)
        while time.perf_counter() < end:
            self.sent += 1
            probe = Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, self.sent))
            self._transport.write(pack(Message("Probe", probe)))
            await asyncio.sleep(PROBE_PERIOD_S)
        give_up = time.perf_counter() + TIMEOUT_S
        while self.echoes < self.sent and time.perf_counter() < give_up:
            await asyncio.sleep(0.05)

    def data_received(self, data: bytes) -> None:
        self._buffer += data
        start, size = 0, len(self._buffer)
        while size - start >= HEADER_BYTES:
            end = start + HEADER_BYTES + struct.unpack_from(">Q", self._buffer, start + 42)[0]
            if end > size:
                break
            name = bytes(self._buffer[start + 14 : start + 34]).rstrip(b"\0")
            self.echoes += name == b"Probe"
            self.poses += name == b"ToolTipToWorld"
            start = end
        del self._buffer[:start]


class _View:
    """Watches the stream and counts the states that come."""

    states = 0

    async def watch(self, session: aiohttp.ClientSession, url: str) -> None:
        async with session.ws_connect(url, protocols=[STREAM]) as stream:
            await stream.send_json(HELLO)
            async for message in stream:
                self.states += message.data.startswith('{"type":"state"')
