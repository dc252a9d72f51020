"""The socket and thread behind the stand-in of Slicer's connector, and what would crash it."""

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


class PeerSocket:
    """Keeps a connection to a server, on a separate thread.

    There `received` is called with each raw message, and `changed` when the connection is open, and
    when it is lost.
    """

    def __init__(
        self,
        host: str,
        port: int,
        received: Callable[[wire.Header, bytes], None],
        changed: Callable[[bool], None],
    ) -> None:
        self._host = host
        self.port = port
        self._received = received
        self._changed = changed
        self._socket: socket.socket | None = None
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._keepConnected, daemon=True)
        self._thread.start()

    def send(self, data: bytes) -> bool:
        """Send, blocking while the peer does not read; return whether it took everything."""
        peer = self._socket
        try:
            if peer is not None:
                peer.sendall(data)
        except OSError:
            return False
        return peer is not None

    def stop(self) -> None:
        self._stopped.set()
        peer = self._socket
        if peer is not None:
            with contextlib.suppress(OSError):  # The other side may have been faster.
                peer.shutdown(socket.SHUT_RDWR)
        self._thread.join()

    def _keepConnected(self) -> None:
        while not self._stopped.is_set():
            with (
                contextlib.suppress(OSError),
                socket.create_connection((self._host, self.port), timeout=1.0) as peer,
            ):
                peer.settimeout(None)
                peer.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self._socket = peer
                self._changed(True)
                with contextlib.suppress(OSError, CrashError), peer.makefile("rb") as stream:
                    while not self._stopped.is_set() and (message := _readMessage(stream)):
                        self._received(*message)
                self._socket = None
                if not self._stopped.is_set():
                    self._changed(False)
            self._stopped.wait(RETRY_PERIOD_S)


def _readMessage(stream) -> tuple[wire.Header, bytes] | None:
    """Return the next message, None at the end.

    The real client takes any bytes for a header, and allocates the size that it reads there.
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
