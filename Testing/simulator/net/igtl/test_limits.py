"""Limits of what a client costs: memory, time, connections; and peers that are no clients."""

import contextlib
import itertools
import json
import socket

import pytest

from rastrainer.igtl.client import Client
from rastrainer.igtl.content import Command, String, Transform
from rastrainer.igtl.message import Message, MessageReader, pack
from rastrainer_simulator.state import Answer
from Testing.simulator.net.igtl.servers import HOST, LinkServer, PlainServer

PROBE = Message("Probe", Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 4, 5, 6)), timestamp=1)
ABORT = pack(Message("command", Command(1, "Abort", "{}")))
# A browser sends this for fetch(url, {method: "POST", mode: "no-cors", body: …}).
FROM_A_PAGE = (
    b"POST / HTTP/1.1\r\nHost: 127.0.0.1:18944\r\nConnection: keep-alive\r\n"
    b"Content-Length: %d\r\nOrigin: http://evil.example\r\nAccept: */*\r\n\r\n"
)


def ended(peer: socket.socket) -> bool:
    """Read to the end; the server may also have reset the connection."""
    with contextlib.suppress(ConnectionError):
        while peer.recv(65_536):
            pass
    return True


def test_a_page_in_a_browser_cannot_send_commands(link_server):
    with socket.create_connection((HOST, link_server.port), 60) as peer:
        peer.sendall(FROM_A_PAGE % len(ABORT) + ABORT)
        assert ended(peer)
    with Client(port=link_server.port) as client:
        assert client.send_command("ListTasks").ok
    assert [name for name, *_ in link_server.simulated.commands] == ["ListTasks"]


def test_occasional_bytes_do_not_keep_a_half_sent_message_alive(start):
    server = start(PlainServer, half_message_s=0.1)
    with socket.create_connection((HOST, server.port), 60) as peer:
        peer.sendall(pack(Message("Note", String("x" * 60_000)))[:70])
        peer.settimeout(0.02)
        for _ in range(6000):
            try:
                peer.send(b"x")
                if peer.recv(1) == b"":
                    break
            except TimeoutError:
                continue
            except ConnectionError:
                break
        else:
            pytest.fail("the connection was kept")


def test_a_client_that_requests_echoes_without_reading_them_is_dropped_before_they_pile_up(start):
    server = start(LinkServer, slow_client_s=60.0, waiting_bytes=300_000)
    metadata = {f"key-{number}": "x" * 10_000 for number in range(6)}
    with Client(port=server.port) as good, socket.socket() as peer:
        peer.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        peer.settimeout(60)
        peer.connect((HOST, server.port))
        with contextlib.suppress(ConnectionError):
            for number in itertools.count():
                peer.sendall(pack(Message(f"Echo {number}", PROBE.content, metadata)))
        assert ended(peer)
        good.send(PROBE)
        assert good.wait_for("Probe").content == PROBE.content


def test_waiting_commands_are_limited_in_bytes(start):
    server = start(LinkServer, commands_at_once=0, waiting_command_bytes=100_000)
    server.simulated.answer = lambda _name, _arguments: Answer(0, True)
    details = {"text": "x" * 30_000}
    scored = {"trialId": "6b8f2f1e-6a60-4c0e-9a37-111111111111", "score": 1, "details": details}
    reader, replies = MessageReader(), []
    with socket.create_connection((HOST, server.port), 60) as peer:
        for number in range(6):
            peer.sendall(
                pack(Message("command", Command(number, "TrialScored", json.dumps(scored))))
            )
        while len(replies) < 2:
            for message in reader.feed(peer.recv(65_536)):
                if message.device == "command":
                    replies.append((message.content.command_id, message.metadata["ErrorMessage"]))
    sentence = "Too many commands wait: wait for their answers."
    assert replies == [(4, sentence), (5, sentence)]


def test_flood_is_read_slowly_but_completely_and_in_order(start):
    server = start(PlainServer, reading_share=0.05)
    with Client(port=server.port) as flood, Client(port=server.port) as other:
        for number in range(300):
            flood.send(Message("Flood", String(str(number))))
        other.send(Message("Other", String("")))
        server.handler.wait_for_messages(301)
    texts = [m.content.text for m in server.handler.messages if m.device == "Flood"]
    assert texts == [str(number) for number in range(300)]
