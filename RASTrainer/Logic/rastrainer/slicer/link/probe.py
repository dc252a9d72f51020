"""Looks an address up and tests once what answers there, without blocking.

Slicer's connector must never meet anything but a simulator: OpenIGTLink's client takes whatever
comes for a message, and ends Slicer over the sizes that it reads from, say, a web page.
"""

from __future__ import annotations

import contextlib
import ipaddress
import selectors
import socket
import threading
import time
from collections.abc import Callable

from rastrainer.slicer.link.peer import Peer, PeerRecognition, ProbeResult, question

POLL_S = 0.005
"""In Slicer another thread runs only while the main thread waits, so it has to wait a little."""

_running: dict[str, AddressLookup] = {}


class AddressLookup:
    """One look-up; only names need one, and a thread for it.

    OpenIGTLink's client speaks IPv4 alone, so other addresses are no use.
    """

    def __init__(self, host: str) -> None:
        self._host = host
        self._ip: str | None = _numericAddress(host)
        self._thread: threading.Thread | None = None
        if self._ip is None:
            self._thread = threading.Thread(target=self._lookUp, daemon=True)
            self._thread.start()

    def process(self) -> str | None:
        """Return the address, empty where the host has none, or None while it is looked up."""
        if self._thread is not None and self._ip is None:
            self._thread.join(POLL_S)
        return self._ip

    def _lookUp(self) -> None:
        try:
            found = socket.getaddrinfo(self._host, None, socket.AF_INET, socket.SOCK_STREAM)
            self._ip = str(found[0][4][0])
        except (OSError, UnicodeError):
            self._ip = ""


def lookUp(host: str) -> AddressLookup:
    """Start looking a host up, or join a running look-up of it."""
    lookup = _running.get(host)
    if lookup is None or lookup.process() is not None:
        lookup = _running[host] = AddressLookup(host)
    return lookup


def _numericAddress(host: str) -> str | None:
    """Return the IPv4 address that needs no look-up, empty for an IPv6 one, else None."""
    if host.lower() == "localhost":
        return "127.0.0.1"
    try:
        address = ipaddress.ip_address(host)
    except ValueError:
        return None
    return str(address) if address.version == 4 else ""


LOOKUP_S = 5.0
ANSWER_S = 3.0
"""How long a name is looked up, and how long an answer is waited for."""
_WAIT_S = 0.005
_PIECE_BYTES = 4096
_MAX_PIECES = 8


class _Connection:
    """A socket that never blocks, with what is to be waited for on it."""

    def __init__(self) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        self._socket.setblocking(False)
        self._selector = selectors.DefaultSelector()
        self._selector.register(self._socket, selectors.EVENT_WRITE)

    def begin(self, ip: str, port: int) -> bool:
        """Begin to connect; return whether that may succeed."""
        try:
            self._socket.connect((ip, port))
        except BlockingIOError:
            pass  # The system continues to connect.
        except OSError:
            return False
        return True

    def close(self) -> None:
        self._selector.close()
        with contextlib.suppress(OSError):
            self._socket.close()

    def isReady(self, waitS: float) -> bool:
        """Return whether it has connected or, after the question, something has arrived."""
        return bool(self._selector.select(waitS))

    def isRefused(self) -> bool:
        return self._socket.getsockopt(socket.SOL_SOCKET, socket.SO_ERROR) != 0

    def ask(self, data: bytes) -> None:
        """Send, and wait for what comes from now on."""
        with contextlib.suppress(OSError):  # What the peer has sent before may still be read.
            self._socket.send(data)
        self._selector.modify(self._socket, selectors.EVENT_READ)

    def receive(self) -> bytes:
        """Return what has arrived; nothing means that the connection has ended."""
        try:
            return self._socket.recv(_PIECE_BYTES)
        except OSError:
            return b""


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
        self._connection: _Connection | None = None
        self._isAsked = False
        self._recognition = PeerRecognition()
        self._finding: ProbeResult | None = None

    def process(self) -> ProbeResult | None:
        """Do what can be done now; return who answers once that is known."""
        if self._finding is None:
            peer = self._proceed()
            if peer is not None:
                self._finding = ProbeResult(peer, self._ip, self._recognition.version)
                self.close()
        return self._finding

    def close(self) -> None:
        """Ask no more."""
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def _proceed(self) -> Peer | None:
        if not self._ip and (peer := self._findAddress()) is not None:
            return peer
        if self._ip and self._connection is None and (peer := self._connect()) is not None:
            return peer
        if self._connection is not None:
            peer = self._converse(self._connection)
            if peer is not None:
                return peer
        return self._giveUp() if self._clock() > self._deadline else None

    def _findAddress(self) -> Peer | None:
        ip = self._lookup.process()
        self._ip = ip or ""
        return Peer.UNKNOWN_HOST if ip == "" else None

    def _connect(self) -> Peer | None:
        self._deadline = self._clock() + ANSWER_S
        self._connection = _Connection()
        return None if self._connection.begin(self._ip, self._port) else Peer.NOBODY

    def _converse(self, connection: _Connection) -> Peer | None:
        """Send the question when there is a connection, then listen."""
        if not self._isAsked:
            if not connection.isReady(_WAIT_S):
                return None
            if connection.isRefused():
                return Peer.NOBODY
            self._isAsked = True
            connection.ask(question())
        for piece in range(_MAX_PIECES):
            if not connection.isReady(_WAIT_S if piece == 0 else 0.0):
                return None
            data = connection.receive()
            if not data:
                return self._recognition.giveUp()
            self._recognition.feed(data)
            if self._recognition.peer is not None:
                return self._recognition.peer
        return None

    def _giveUp(self) -> Peer:
        if not self._ip:
            return Peer.UNKNOWN_HOST
        return self._recognition.giveUp() if self._isAsked else Peer.NOBODY
