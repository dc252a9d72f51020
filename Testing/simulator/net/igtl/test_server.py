"""The server on real sockets: bad clients do not disturb good clients."""

import asyncio
import contextlib
import logging
import math
import socket
import struct
from itertools import pairwise

import pytest

from rastrainer.igtl.client import Client
from rastrainer.igtl.content import String, Transform
from rastrainer.igtl.message import Message, crc64, pack
from rastrainer_simulator.net.igtl.outgoing import Outgoing
from Testing.simulator.net.igtl.servers import HOST, LinkServer, PlainServer

PROBE = Message("Probe", Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 4, 5, 6)), timestamp=1)
LONG_TEXT = Outgoing(Message("Text", String("x" * 60_000)))


def connect(port: int, receive_buffer: int = 0) -> socket.socket:
    peer = socket.socket()
    if receive_buffer:
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
    peer.settimeout(60)
    peer.connect((HOST, port))
    return peer


def read_to_end(peer: socket.socket) -> bytes:
    data = b""
    with contextlib.suppress(ConnectionError):
        while piece := peer.recv(65_536):
            data += piece
    return data


async def until(condition):
    while not condition():
        await asyncio.sleep(0.001)


def of_version_1(content: bytes, checksum: int | None = None, kind: bytes = b"TRANSFORM") -> bytes:
    checksum = crc64(content) if checksum is None else checksum
    return struct.pack(">H12s20sIIQQ", 1, kind, b"", 0, 0, len(content), checksum) + content


@pytest.mark.parametrize(
    "useless",
    [
        of_version_1(b"", 0, b"GET_STATUS"),
        of_version_1(bytes(70_000), 0, b"IMAGE")[:58],
        of_version_1(PROBE.content.pack(), 0),
        of_version_1(struct.pack(">12f", *[math.nan] * 12)),
    ],
    ids=["asks", "image begun", "without checksum", "not a number"],
)
def test_what_speaks_header_version_1_is_answered_in_it_whatever_it_sends(start, useless):
    server = start(LinkServer, first_message_s=3600.0)
    with connect(server.port) as peer, peer.makefile("rb") as stream:
        peer.sendall(useless)
        version, *_rest = struct.unpack(">H12s20sIIQQ", stream.read(58))
    assert version == 1


def test_client_that_does_not_read_is_dropped_and_disturbs_no_other(start):
    server = start(LinkServer, slow_client_s=0.2)
    with Client(port=server.port) as good:
        good.wait_for("SimServer")
        (first,) = server.server.clients
        with connect(server.port, receive_buffer=4096):
            server.thread.run(until(lambda: len(server.server.clients) == 2))
            # The good one could be late, too.
            (silent,) = {*server.server.clients} - {first}
            while len(server.server.clients) == 2:
                server.thread.call(silent.send_latest, LONG_TEXT)
        good.send(PROBE)
        assert good.wait_for("Probe").content == PROBE.content


def test_state_of_a_slowly_reading_client_is_replaced_instead_of_piling_up(start):
    server = start(PlainServer, slow_client_s=600, silent_peer_s=600, waiting_bytes=200_000)
    with connect(server.port, receive_buffer=4096) as peer, peer.makefile("rb") as stream:
        server.handler.wait_until(lambda: server.handler.connections)
        (connection,) = server.server.clients
        texts = [Outgoing(Message("Text", String(f"{i:03}" * 20_000))) for i in range(200)]
        for text in texts:
            server.thread.call(connection.send_latest, text)
        read = []
        while not read or read[-1] != b"199":
            size = struct.unpack(">Q", stream.read(58)[42:50])[0]
            read.append(stream.read(size)[16:19])
        assert len(read) < 100
        assert read == sorted(read)


def test_the_oldest_silent_client_is_dropped_when_its_slot_is_needed(start):
    server = start(PlainServer, clients=3)
    with connect(server.port) as talking, contextlib.ExitStack() as stack:
        talking.sendall(pack(PROBE))
        server.handler.wait_for_messages(1)
        silent = [stack.enter_context(connect(server.port)) for _ in range(2)]
        server.handler.wait_until(lambda: len(server.handler.connections) == 3)
        for number in range(2):
            newcomer = stack.enter_context(connect(server.port))
            newcomer.sendall(pack(PROBE))
            server.handler.wait_for_messages(2 + number)
            assert read_to_end(silent[number]) == b""
        talking.sendall(pack(PROBE))
        server.handler.wait_for_messages(4)
        assert len(server.server.clients) == 3


def test_problems_are_logged_at_most_once_a_second(plain_server, caplog):
    with caplog.at_level(logging.WARNING, "rastrainer.igtl"), connect(plain_server.port) as peer:
        for _ in range(500):
            peer.sendall(of_version_1(b"", kind=b"IMAGE"))
        peer.sendall(pack(PROBE))
        plain_server.handler.wait_for_messages(1)
        assert "unsupported type" in caplog.records[0].getMessage()
        times = [record.created for record in caplog.records]
        assert all(after - before > 0.9 for before, after in pairwise(times))
