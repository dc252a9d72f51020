"""A simple client: one connection, one receiving thread, blocking commands."""

from __future__ import annotations

import contextlib
import itertools
import json
import socket
import threading
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from concurrent.futures import TimeoutError as NoResult
from dataclasses import dataclass, field
from typing import Any

from rastrainer.commands import decode_answer_object
from rastrainer.errors import InputError, RASTrainerError
from rastrainer.igtl.content import ERROR_KEY, STATUS_KEY, SUCCESS, Command, CommandReply
from rastrainer.igtl.message import Message, MessageReader, pack
from rastrainer.protocol import DEFAULT_HOST, DEFAULT_PORT, DeviceName

PATIENCE_S = 60.0
"""How long to wait by default, s: a busy machine may take some seconds to answer."""
_PIECE_BYTES = 64 * 1024


class LinkError(RASTrainerError):
    """The connection failed, was lost, or timed out."""


@dataclass(frozen=True)
class Reply:
    """The answer to a command: success, error message and data."""

    ok: bool
    error: str = ""
    data: Mapping[str, Any] = field(default_factory=dict)


class Client:
    """A connection to an OpenIGTLink server; close it, or use it in a `with` statement.

    `on_message` is called in the receiving thread with every message except answers to
    `send_command`; it must not wait for an answer itself. `latest` has the last message of each
    device; `is_open` says whether the connection is open, as far as this side knows.
    """

    def __init__(
        self,
        host: str = DEFAULT_HOST,
        port: int = DEFAULT_PORT,
        on_message: Callable[[Message], None] | None = None,
        timeout: float = PATIENCE_S,
    ):
        """Connect within `timeout` seconds, or raise `LinkError`."""
        try:
            self._socket = socket.create_connection((host, port), timeout)
        except OSError as error:
            reason = error.strerror or "no answer in time"
            raise LinkError(f"No connection to {host}:{port}: {reason}.") from None
        self._socket.settimeout(None)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._on_message = on_message
        self._reader = MessageReader()
        self._sending = threading.Lock()
        self._news = threading.Condition()
        self._numbers = itertools.count(1)
        self._waiting: dict[int, Future[Reply]] = {}
        self.is_open = True
        self.latest: dict[str, Message] = {}
        self._thread = threading.Thread(target=self._receive, name="igtl-client", daemon=True)
        self._thread.start()

    def __enter__(self) -> Client:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    def close(self) -> None:
        with contextlib.suppress(OSError):  # The peer may have closed it first.
            self._socket.shutdown(socket.SHUT_RDWR)
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def send(self, message: Message) -> None:
        """Send one message; raise `LinkError` if the connection is lost."""
        data = pack(message)
        try:
            with self._sending:
                self._socket.sendall(data)
        except OSError:
            raise LinkError("The connection is lost.") from None

    def send_command(
        self, name: str, arguments: Mapping[str, Any] | None = None, timeout: float = PATIENCE_S
    ) -> Reply:
        """Send a command and return its answer; raise `LinkError` if there is none in time."""
        number = next(self._numbers)
        answer: Future[Reply] = Future()
        self._waiting[number] = answer
        try:
            body = json.dumps(dict(arguments or {}), allow_nan=False)
            self.send(Message(DeviceName.COMMAND, Command(number, name, body)))
            if not self.is_open and not answer.done():
                raise LinkError("The connection is lost.")
            return answer.result(timeout)
        except NoResult:
            raise LinkError(f"No answer to {name} within {timeout:g} s.") from None
        finally:
            self._waiting.pop(number, None)

    def wait_for(
        self,
        device: str,
        accept: Callable[[Message], bool] = lambda _message: True,
        timeout: float = PATIENCE_S,
    ) -> Message:
        """Return the latest message of `device` that `accept` accepts, waiting for it if needed."""

        def has_arrived() -> bool:
            return device in self.latest and accept(self.latest[device])

        with self._news:
            self._news.wait_for(lambda: has_arrived() or not self.is_open, timeout)
            if has_arrived():
                return self.latest[device]
            if not self.is_open:
                raise LinkError("The connection is lost.")
            raise LinkError(f"No matching message from {device} within {timeout:g} s.")

    def _receive(self) -> None:
        try:
            while not self._reader.refusal:
                data = self._socket.recv(_PIECE_BYTES)
                if not data:
                    break
                for message in self._reader.feed(data):
                    self._accept(message)
        except OSError:
            pass  # A reset connection is a closed one.
        finally:
            self._socket.close()
            with self._news:
                self.is_open = False
                self._news.notify_all()
            for answer in list(self._waiting.values()):
                answer.set_exception(LinkError("The connection is lost."))

    def _accept(self, message: Message) -> None:
        if type(message.content) is CommandReply:
            answer = self._waiting.pop(message.content.command_id, None)
            if answer is None:
                return
            is_success = message.metadata.get(STATUS_KEY) == SUCCESS
            error = message.metadata.get(ERROR_KEY, "")
            try:
                data = decode_answer_object(message.content.body)
                answer.set_result(Reply(is_success, error, data))
            except InputError:
                answer.set_exception(LinkError("An answer's body must be a JSON object."))
            return
        with self._news:
            self.latest[message.device] = message
            self._news.notify_all()
        if self._on_message is not None:
            self._on_message(message)
