"""Asks once who answers at an address, without ever waiting for it.

Slicer's connector must never meet anything but a simulator: OpenIGTLink's client takes whatever
comes for a message, and ends Slicer over the sizes that it reads from, say, a web page.
"""

from __future__ import annotations

import contextlib
import selectors
import socket
import time
from collections.abc import Callable

from rastrainer.slicer.address_lookup import lookUp
from rastrainer.slicer.finding import Finding, Peer
from rastrainer.slicer.peer_recognition import PeerRecognition, question

LOOKUP_S = 5.0
ANSWER_S = 3.0
"""How long a name is looked up, and how long an answer is waited for."""
_WAIT_S = 0.005
_PIECE_BYTES = 4096
_MOST_PIECES = 8


class Probe:
    """One question, on a socket that never blocks; `process` is called until it returns a finding.

    No thread: in Slicer another thread runs only while the main thread waits, and a socket that is
    looked at now and then needs none. A call of `process` takes some milliseconds at most.
    """

    def __init__(self, host: str, port: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._port = port
        self._clock = clock
        self._lookup = lookUp(host)
        self._ip = ""
        self._deadline = clock() + LOOKUP_S
        self._socket: socket.socket | None = None
        self._selector: selectors.BaseSelector | None = None
        self._isAsked = False
        self._recognition = PeerRecognition()
        self._finding: Finding | None = None

    def process(self) -> Finding | None:
        """Do what can be done now; return who answers once that is known."""
        if self._finding is None:
            peer = self._proceed()
            if peer is not None:
                self._finding = Finding(peer, self._ip, self._recognition.version)
                self.close()
        return self._finding

    def close(self) -> None:
        """Ask no more."""
        if self._socket is not None:
            self._selector.close()
            with contextlib.suppress(OSError):
                self._socket.close()
            self._socket = None

    def _proceed(self) -> Peer | None:
        if not self._ip and (peer := self._findAddress()) is not None:
            return peer
        if self._ip and self._socket is None and (peer := self._connect()) is not None:
            return peer
        if self._socket is not None and (peer := self._converse()) is not None:
            return peer
        return self._giveUp() if self._clock() > self._deadline else None

    def _findAddress(self) -> Peer | None:
        ip = self._lookup.process()
        self._ip = ip or ""
        return Peer.UNKNOWN_HOST if ip == "" else None

    def _connect(self) -> Peer | None:
        self._deadline = self._clock() + ANSWER_S
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        self._socket.setblocking(False)
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._socket, selectors.EVENT_WRITE)
        try:
            self._socket.connect((self._ip, self._port))
        except BlockingIOError:
            pass  # It goes on by itself.
        except OSError:
            return Peer.NOBODY
        return None

    def _converse(self) -> Peer | None:
        """Ask as soon as there is a connection, then listen."""
        if not self._isAsked:
            if not self._selector.select(_WAIT_S):
                return None
            if self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR):
                return Peer.NOBODY
            self._isAsked = True
            with contextlib.suppress(OSError):  # What has been said before may still be read.
                self._socket.send(question())
            self._selector.modify(self._socket, selectors.EVENT_READ)
        for _piece in range(_MOST_PIECES):
            if not self._selector.select(_WAIT_S if _piece == 0 else 0):
                return None
            data = self._received()
            if not data:
                return self._recognition.giveUp()
            self._recognition.feed(data)
            if self._recognition.peer is not None:
                return self._recognition.peer
        return None

    def _received(self) -> bytes:
        """Return what has arrived; nothing means that the connection has ended."""
        try:
            return self._socket.recv(_PIECE_BYTES)
        except OSError:
            return b""

    def _giveUp(self) -> Peer:
        if not self._ip:
            return Peer.UNKNOWN_HOST
        return self._recognition.giveUp() if self._isAsked else Peer.NOBODY
