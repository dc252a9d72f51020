"""The sockets and threads behind the stand-in of Slicer's connector and what would crash it."""

from __future__ import annotations

import contextlib
import logging
import socket
import threading
from collections.abc import Callable

from rastrainer.igtl import message as wire

crashes: list[str] = []
"""What would have crashed Slicer, one sentence each."""


class CrashError(RuntimeError):
    """Slicer would have crashed."""


def recordCrash(sentence: str) -> CrashError:
    """Record a crash, from any thread; the caller may raise the error."""
    crashes.append(sentence)
    logging.critical("Slicer would not have survived: %s", sentence)
    return CrashError(sentence)


RETRY_PERIOD_S = 0.1
CRASHING_BODY = 2**31
_VERSIONS = (b"\0\1", b"\0\2")

Received = Callable[[int, wire.Header, bytes], None]


class PeerSockets:
    """Keeps one connection to a server, or listens for many clients, on separate threads.

    `received` is called on a thread with the peer's number and each raw message; `changed` whenever
    a peer is there, or the last one has left; Slicer too finds out only every 100 ms.
    """

    def __init__(
        self,
        listens: bool,
        host: str,
        port: int,
        received: Received,
        changed: Callable[[bool], None],
    ) -> None:
        self._host = host
        self.port = port
        self._received = received
        self._changed = changed
        self._peers: dict[int, socket.socket] = {}
        self._receivers: dict[int, threading.Thread] = {}
        self._lock = threading.Lock()
        self._stopped = threading.Event()
        self._nextPeer = 0
        self._isConnected = False
        self._listener = socket.create_server((host, port)) if listens else None
        if self._listener is not None:
            self._listener.settimeout(RETRY_PERIOD_S)
        self._thread = threading.Thread(target=self._keepConnected, daemon=True)
        self._thread.start()

    def send(self, data: bytes) -> bool:
        """Send to every peer, blocking while one does not read; return whether all took it."""
        with self._lock:
            peers = list(self._peers.values())
        try:
            for peer in peers:
                peer.sendall(data)
        except OSError:
            return False
        return bool(peers)

    def stop(self) -> None:
        self._stopped.set()
        self._thread.join()
        if self._listener is not None:
            self._listener.close()
        with self._lock:
            peers, receivers = list(self._peers.values()), list(self._receivers.values())
        for peer in peers:
            _shut(peer)
        for receiver in receivers:
            receiver.join()

    def _keepConnected(self) -> None:
        while not self._stopped.is_set():
            with contextlib.suppress(OSError):
                if self._listener is not None:
                    self._add(self._listener.accept()[0])
                elif not self._peers:
                    self._add(socket.create_connection((self._host, self.port), timeout=1.0))
            with self._lock:
                isConnected = bool(self._peers)
            if isConnected != self._isConnected:
                self._isConnected = isConnected
                self._changed(isConnected)
            self._stopped.wait(RETRY_PERIOD_S)

    def _add(self, peer: socket.socket) -> None:
        peer.settimeout(None)
        peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        number = self._nextPeer
        self._nextPeer += 1
        receiver = threading.Thread(target=self._receive, args=(number, peer), daemon=True)
        with self._lock:
            self._peers[number], self._receivers[number] = peer, receiver
        receiver.start()

    def _receive(self, number: int, peer: socket.socket) -> None:
        try:
            with peer.makefile("rb") as stream:
                while (message := _readMessage(stream)) is not None:
                    self._received(number, *message)
        except (OSError, CrashError):
            pass
        finally:
            _shut(peer)
            with self._lock:
                del self._peers[number], self._receivers[number]


def _readMessage(stream) -> tuple[wire.Header, bytes] | None:
    """Return the next message, None at the end.

    The real client takes whatever comes for a header, and makes room for as much as it reads there.
    """
    start = stream.read(len(_VERSIONS[0]))
    if len(start) < len(_VERSIONS[0]):
        return None
    if start not in _VERSIONS:
        raise recordCrash("The connector met something that is not OpenIGTLink.")
    headerBytes = start + stream.read(wire.HEADER_BYTES - len(start))
    if len(headerBytes) < wire.HEADER_BYTES:
        return None
    header = wire.read_header(headerBytes)
    if header is None or header.body_size >= CRASHING_BODY:
        raise recordCrash("The peer sent a header that no OpenIGTLink message has.")
    body = stream.read(header.body_size)
    return (header, body) if len(body) == header.body_size else None


def _shut(peer: socket.socket) -> None:
    with contextlib.suppress(OSError):  # The other side may have been faster.
        peer.shutdown(socket.SHUT_RDWR)
    peer.close()
