"""Servers that are not simulators, on real sockets: the module must not connect to them."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Callable, Iterator

from Testing.free_port import free_port

Behavior = Callable[[socket.socket], None]

SLOW_S = 30.0


@contextlib.contextmanager
def stranger(behavior: Behavior, port: int = 0) -> Iterator[int]:
    """Let `behavior` serve each connection in a separate thread; yield the port."""
    over = threading.Event()
    peers = []

    def serve() -> None:
        while not over.is_set():
            try:
                peer = listener.accept()[0]
            except OSError:
                return
            peers.append(peer)
            threading.Thread(target=_behave, args=(behavior, peer), daemon=True).start()

    with socket.create_server(("127.0.0.1", port or free_port())) as listener:
        thread = threading.Thread(target=serve, daemon=True)
        thread.start()
        try:
            yield listener.getsockname()[1]
        finally:
            over.set()
            for each in (listener, *peers):
                with contextlib.suppress(OSError):
                    each.shutdown(socket.SHUT_RDWR)
                each.close()
            thread.join()


def says(data: bytes) -> Behavior:
    """Send something at once, and then nothing more."""

    def behave(peer: socket.socket) -> None:
        peer.sendall(data)
        peer.recv(65536)
        time.sleep(SLOW_S)

    return behave


def replies_with(data: bytes) -> Behavior:
    """Answer every peer that has sent something."""

    def behave(peer: socket.socket) -> None:
        peer.recv(65536)
        peer.sendall(data)

    return behave


def is_silent(peer: socket.socket) -> None:
    """Accept the connection and send nothing."""
    peer.recv(65536)
    time.sleep(SLOW_S)


def trickles(data: bytes) -> Behavior:
    """Send the same again and again, a byte at a time."""

    def behave(peer: socket.socket) -> None:
        while True:
            for byte in data:
                peer.sendall(bytes([byte]))
                time.sleep(0.01)

    return behave


def floods(data: bytes) -> Behavior:
    """Send the same endlessly, as fast as it is received."""

    def behave(peer: socket.socket) -> None:
        while True:
            peer.sendall(data)

    return behave


def _behave(behavior: Behavior, peer: socket.socket) -> None:
    with contextlib.suppress(OSError):
        behavior(peer)
        peer.shutdown(socket.SHUT_RDWR)
