"""A small OpenIGTLink server for the tests of Slicer's side: real sockets, scripted answers."""

from __future__ import annotations

import contextlib
import json
import queue
import socket
import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.igtl.client import Reply
from rastrainer.igtl.content import (
    ERROR_KEY,
    FAIL,
    STATUS_KEY,
    SUCCESS,
    Command,
    CommandReply,
    Status,
)
from rastrainer.igtl.message import Message, MessageReader, pack
from rastrainer.protocol import PROTOCOL_VERSION, DeviceName
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.link.link import Link
from rastrainer_headless.connector import headlessKit
from Testing.free_port import free_port

HEARTBEAT_PERIOD_S = 1.0
Refusal = str
Responder = Callable[[str, dict[str, Any]], "Mapping[str, Any] | Refusal | None"]


class SimulatorDouble:
    """Listens on a free port of the loopback; `port` may be given to reuse the same one.

    `responder(name, arguments)` gives each command's answer: data, a refusal in words, or None
    for no answer. Everything received is in `commands`. As the simulator does, it sends
    its heartbeat to each peer that sends a first message, and then once a second; if `beats` is
    False, only to peers that ask.
    """

    def __init__(
        self, responder: Responder | None = None, port: int = 0, version: int = PROTOCOL_VERSION
    ) -> None:
        self.beats = True
        self.heartbeat = Message(DeviceName.SIM_SERVER, Status(Status.OK, subcode=version))
        self.responder = responder or (lambda _name, _arguments: {})
        self._listener = socket.create_server(("127.0.0.1", port or free_port()))
        self.port = self._listener.getsockname()[1]
        self._peers: list[socket.socket] = []
        self._greeted: list[socket.socket] = []
        self._isClosed = threading.Event()
        self._lock = threading.Lock()
        self._nextNumber = 1
        self.received: queue.Queue[Message] = queue.Queue()
        self.commands: list[tuple[str, dict[str, Any]]] = []
        threading.Thread(target=self._accept, daemon=True).start()
        threading.Thread(target=self._beat, daemon=True).start()

    def __enter__(self) -> SimulatorDouble:
        return self

    def __exit__(self, *_exception: object) -> None:
        self.close()

    @property
    def peer_count(self) -> int:
        with self._lock:
            return len(self._peers)

    def stop_listening(self) -> None:
        """Free the port, and stay connected to the present peers."""
        _close(self._listener)

    def close(self) -> None:
        self._isClosed.set()
        for open_socket in (self._listener, *self._peers):
            _close(open_socket)

    def send(self, device: str, content: Any, metadata: Mapping[str, str] | None = None) -> None:
        self.send_bytes(pack(Message(device, content, metadata or {})))

    def send_bytes(self, data: bytes) -> None:
        with self._lock:
            for peer in self._peers:
                with contextlib.suppress(OSError):  # A peer of an earlier connection has left.
                    peer.sendall(data)

    def send_command(self, name: str, arguments: Mapping[str, Any]) -> None:
        command = Command(self._nextNumber, name, json.dumps(arguments))
        self._nextNumber += 1
        self.send(DeviceName.COMMAND, command)

    def _accept(self) -> None:
        while True:
            try:
                peer = self._listener.accept()[0]
            except OSError:
                return
            with self._lock:
                self._peers.append(peer)
            if self._isClosed.is_set():
                # A caller that closes all peers may have missed this one.
                _close(peer)
            threading.Thread(target=self._receive, args=(peer,), daemon=True).start()

    def _receive(self, peer: socket.socket) -> None:
        # The odd greeting of Slicer has no device name; our reader accepts it.
        reader = MessageReader()
        is_greeted = False
        try:
            while data := peer.recv(65536):
                for message in reader.feed(data):
                    if not is_greeted:
                        is_greeted = True
                        self._greet(peer, message)
                    self.received.put(message)
                    if type(message.content) is Command:
                        self._answer(peer, message.content)
        except OSError:
            pass

    def _greet(self, peer: socket.socket, message: Message) -> None:
        if self.beats or message.device == "RASTrainer":
            with self._lock:
                peer.sendall(pack(self.heartbeat))
                self._greeted.append(peer)

    def _beat(self) -> None:
        while not self._isClosed.wait(HEARTBEAT_PERIOD_S):
            if not self.beats:
                continue
            with self._lock:
                for peer in self._greeted:
                    with contextlib.suppress(OSError):
                        peer.sendall(pack(self.heartbeat))

    def _answer(self, peer: socket.socket, command: Command) -> None:
        arguments = json.loads(command.body or "{}")
        self.commands.append((command.name, arguments))
        answer = self.responder(command.name, arguments)
        if answer is None:
            return
        is_refusal = isinstance(answer, str)
        metadata = {STATUS_KEY: FAIL, ERROR_KEY: answer} if is_refusal else {STATUS_KEY: SUCCESS}
        body = "{}" if is_refusal else json.dumps(answer)
        reply = CommandReply(command.command_id, command.name, body)
        with self._lock:
            peer.sendall(pack(Message(DeviceName.COMMAND, reply, metadata)))


class LinkedLab:
    """A link to a simulator double, and background work, driven without a host."""

    def __init__(self, scene: Any, responder: Responder | None = None) -> None:
        self.scene = scene
        self.simulator = SimulatorDouble(responder)
        self.link = Link(scene, headlessKit)
        self.work = BackgroundWork()

    def connect(self) -> None:
        """Connect, and finish the work that begins with that."""
        opened: list[bool] = []
        self.link.opened.connect(lambda: opened.append(True))
        self.link.connectTo(port=self.simulator.port)
        self.run_until(lambda: opened and not self.work.isBusy)

    def sent(self, name: str) -> list[dict[str, Any]]:
        """Return the arguments of the received commands of a name."""
        return [arguments for sent, arguments in self.simulator.commands if sent == name]

    def all_sent(self, name: str) -> list[dict[str, Any]]:
        """Return the arguments of all commands of a name, none of which is still in transit."""
        run_until_received(self.link)
        return self.sent(name)

    def run_until(self, condition: Callable[[], Any]) -> None:
        run_logic_until(self.link, self.work, condition)

    def close(self) -> None:
        self.link.disconnect()
        self.work.close()
        self.simulator.close()


def _close(open_socket: socket.socket) -> None:
    # Shutting down wakes the thread in accept; closing alone leaves it there.
    with contextlib.suppress(OSError):
        open_socket.shutdown(socket.SHUT_RDWR)
    open_socket.close()


def wait_until(condition: Callable[[], Any], process: Callable[[], None], timeout: float = 120.0):
    """Call `process` every few ms until `condition()`; the host's timer, in a test."""
    end = time.monotonic() + timeout
    while not condition():
        assert time.monotonic() < end, "the awaited did not happen in time"
        process()
        time.sleep(0.002)


def process_link(link: Link) -> None:
    """Do for a link what Slicer's timers do."""
    if link.connector is not None:
        link.connector.PeriodicProcess()
    link.process()


def connect_module(host, simulator):
    """Connect the module that is open in the host, and wait until it has received the heartbeat."""
    host.type("portSpinBox", str(simulator.port))
    host.press("connectButton")
    host.wait_until(lambda: simulator.commands, "the module sends its greeting")
    simulator.send(DeviceName.SIM_SERVER, Status(Status.OK, subcode=PROTOCOL_VERSION))
    host.wait_until(lambda: host.text("stateText").startswith("Connected"), "the heartbeat")


def run_link_until(link: Link, condition: Callable[[], Any], timeout: float = 120.0) -> None:
    """Let the link work until `condition()`."""
    wait_until(condition, lambda: process_link(link), timeout)


def run_until_received(link: Link) -> None:
    """Let the link work until the simulator has received all commands that were sent before.

    They arrive in their order: once a later command is answered, all have arrived.
    """
    replies: list[Reply] = []
    link.send(CommandName.LIST_TASKS, onReply=replies.append)
    run_link_until(link, lambda: replies)


def run_logic_until(
    link: Link, work: BackgroundWork, condition: Callable[[], Any], timeout: float = 180.0
) -> None:
    """Let the link and the background work proceed until `condition()`."""

    def process() -> None:
        process_link(link)
        work.process()

    wait_until(condition, process, timeout)
