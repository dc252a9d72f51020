"""The plain client with a minimal server."""

from __future__ import annotations

import contextlib
import socket
import threading
from dataclasses import replace

import pytest

from rastrainer.igtl.client import Client, LinkError
from rastrainer.igtl.content import CommandReply, Transform
from rastrainer.igtl.message import Message, MessageReader, pack
from Testing.free_port import free_port

TIP = Message("Tip", Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 5, 6, 7)), timestamp=1)
SUCCESS = {"Status": "SUCCESS"}


class Peer:
    """A server for one client that handles each message with `answer`."""

    def __init__(self, answer=lambda _peer, _message: None, greeting: bytes = b""):
        self._answer = answer
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.port = self._listener.getsockname()[1]
        self._greeting = greeting
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()

    def send(self, *messages: Message) -> None:
        self._connection.sendall(b"".join(pack(message) for message in messages))

    def hang_up(self) -> None:
        self._connection.shutdown(socket.SHUT_RDWR)

    def close(self) -> None:
        self._listener.close()
        self._thread.join(60)

    def _serve(self) -> None:
        reader = MessageReader()
        self._connection, _address = self._listener.accept()
        with self._connection, contextlib.suppress(OSError):
            self._connection.sendall(self._greeting)
            while data := self._connection.recv(65_536):
                for message in reader.feed(data):
                    self._answer(self, message)


@pytest.fixture
def connect():
    """Makes servers with a client each, and closes them."""
    with contextlib.ExitStack() as stack:

        def make(*arguments, on_message=None, **options):
            peer = stack.enter_context(contextlib.closing(Peer(*arguments, **options)))
            return stack.enter_context(Client(port=peer.port, on_message=on_message))

        yield make


def reply_to(message: Message, body: str = "{}", metadata=SUCCESS) -> Message:
    command = message.content
    return Message("command", CommandReply(command.command_id, command.name, body), metadata)


def test_answers_are_matched_by_number_in_any_order(connect):
    held, has_first = [], threading.Event()

    def answer_backward(server, message):
        held.append(message)
        has_first.set()
        if len(held) == 2:
            server.send(*(reply_to(m, f'{{"to": "{m.content.name}"}}') for m in reversed(held)))

    client, first = connect(answer_backward), []
    thread = threading.Thread(target=lambda: first.append(client.send_command("A")))
    thread.start()
    has_first.wait(60)
    assert client.send_command("B").data == {"to": "B"}
    thread.join()
    assert first[0].data == {"to": "A"}


def test_a_refusal_is_returned_with_its_message(connect):
    fail = {"Status": "FAIL", "ErrorMessage": "Begin with StartTask."}
    client = connect(lambda server, message: server.send(reply_to(message, metadata=fail)))
    reply = client.send_command("Capture")
    assert (reply.ok, reply.error) == (False, "Begin with StartTask.")


def test_a_missing_answer_and_a_lost_connection_end_the_wait(connect):
    with pytest.raises(LinkError, match=r"No answer to Capture within 0\.05 s"):
        connect().send_command("Capture", timeout=0.05)
    client = connect(lambda server, _message: server.hang_up())
    for wait in (lambda: client.send_command("Capture"), lambda: client.wait_for("Tip")):
        with pytest.raises(LinkError, match="The connection is lost"):
            wait()
    assert not client.is_open


def test_answer_that_is_not_a_json_object_is_an_error_and_the_link_survives(connect):
    bodies = ["[]", "no JSON", '{"x": NaN}', "{}"]
    client = connect(lambda server, message: server.send(reply_to(message, bodies.pop(0))))
    for _ in range(3):
        with pytest.raises(LinkError, match="must be a JSON object"):
            client.send_command("Capture")
    assert client.send_command("Capture").ok


def test_answer_without_a_status_is_not_a_success(connect):
    # Answers of header version 2 need a status; version 1 cannot carry it.
    def answer(server, message):
        server.send(replace(reply_to(message, metadata={}), version=1))

    assert not connect(answer).send_command("Capture").ok


def test_refused_connection_raises_a_one_sentence_error():
    port = free_port()
    with pytest.raises(LinkError, match=f"No connection to 127.0.0.1:{port}: "):
        Client(port=port)
