"""Looks up an address and tests once what answers there, without blocking.

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

from rastrainer.igtl.content import Status
from rastrainer.igtl.message import Message, MessageReader, pack
from rastrainer.protocol import DeviceName
from rastrainer.slicer.link.link_status import Peer, ProbeResult

MAX_BYTES = 64 * 1024
"""Most bytes read; a simulator's heartbeat comes among the first hundreds."""
MAX_STATUS_BYTES = 4096

_HEADERS = (b"\0\1", b"\0\2")
_WEB_PAGES = (b"HTTP/", b"<")
_TLS_ALERT = b"\x15\x03"


def question() -> bytes:
    """Return a message that a simulator answers with its heartbeat.

    A STATUS, as Slicer itself begins each connection with, does no harm to any OpenIGTLink program;
    its text ends as the request of a browser does, so that a web server answers, too.
    """
    status = Status(Status.OK, message="Who is there?\r\n\r\n")
    return pack(Message("RASTrainer", status, {"client": "connection test"}))


class PeerRecognition:
    """Takes the bytes of one peer as they come.

    Attributes:
        peer: who it is, as far as that is certain; else None.
        version: of the protocol, where it is a simulator.
    """

    def __init__(self) -> None:
        self.peer: Peer | None = None
        self.version = 0
        self._start = b""
        self._size = 0
        self._reader = MessageReader({Status.TYPE: MAX_STATUS_BYTES})

    def feed(self, data: bytes) -> None:
        """Take what has arrived."""
        self._size += len(data)
        self._start += data[: max(0, 8 - len(self._start))]
        if self.peer is None:
            self.peer = self._judgeStart() or self._judgeMessages(data)

    def giveUp(self) -> Peer:
        """Return who it is if nothing more comes."""
        if self.peer is not None:
            return self.peer
        if not self._size:
            return Peer.SILENT
        return Peer.OTHER_OPENIGTLINK if self._reader.taken else Peer.OTHER_PROGRAM

    def _judgeStart(self) -> Peer | None:
        start = self._start
        if any(start.startswith(sign) for sign in _WEB_PAGES):
            return Peer.WEB_PAGE
        if start.startswith(_TLS_ALERT):
            return Peer.ENCRYPTED
        known = (*_HEADERS, *_WEB_PAGES, _TLS_ALERT)
        isPossible = any(sign[: len(start)] == start[: len(sign)] for sign in known)
        return None if isPossible else Peer.OTHER_PROGRAM

    def _judgeMessages(self, data: bytes) -> Peer | None:
        for message in self._reader.feed(data):
            # The reader lets nothing but STATUS through.
            if message.device == DeviceName.SIM_SERVER and isinstance(message.content, Status):
                self.version = message.content.subcode
                return Peer.SIMULATOR
        if self._reader.refusal:
            return Peer.OTHER_OPENIGTLINK if self._reader.taken else Peer.OTHER_PROGRAM
        return Peer.OTHER_OPENIGTLINK if self._size > MAX_BYTES else None


POLL_S = 0.005
"""How long each poll waits: in Slicer other threads run only while the main thread waits."""

_running: dict[str, AddressLookup] = {}


class AddressLookup:
    """One look-up; only names need one, and a thread for it.

    OpenIGTLink's client speaks IPv4 alone, so other addresses are useless.

    Attributes:
        isOnlyIpv6: whether the host has none but IPv6 addresses.
    """

    def __init__(self, host: str) -> None:
        self._host = host
        self._ip: str | None = _numericAddress(host)
        self.isOnlyIpv6 = self._ip == ""
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
        ip = _findAddress(self._host, socket.AF_INET)
        self.isOnlyIpv6 = not ip and bool(_findAddress(self._host, socket.AF_INET6))
        self._ip = ip


def lookUp(host: str) -> AddressLookup:
    """Start looking up a host, or join a running look-up of it."""
    lookup = _running.get(host)
    if lookup is None or lookup.process() is not None:
        lookup = _running[host] = AddressLookup(host)
    return lookup


def _findAddress(host: str, family: socket.AddressFamily) -> str:
    """Return an address of a host, empty where it has none of this family."""
    try:
        return str(socket.getaddrinfo(host, None, family, socket.SOCK_STREAM)[0][4][0])
    except (OSError, UnicodeError):
        return ""


def _numericAddress(host: str) -> str | None:
    """Return the IPv4 address that needs no look-up, empty for an IPv6 one, else None."""
    if host.lower() == "localhost":
        return "127.0.0.1"
    try:
        # As in `[::1]`, which separates an address of IPv6 from a port.
        address = ipaddress.ip_address(host.removeprefix("[").removesuffix("]"))
    except ValueError:
        return None
    if isinstance(address, ipaddress.IPv6Address):
        return str(address.ipv4_mapped or "")
    return str(address)


LOOKUP_S = 5.0
ANSWER_S = 3.0
"""How long to look up a name, and how long to wait for an answer."""
_PIECE_BYTES = 4096
_MAX_PIECES = 8


class _Connection:
    """A socket that never blocks, with the event to wait for on it."""

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
    polled now and then needs none. A call of `process` takes some milliseconds at most.
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
        """Stop asking."""
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
        if ip != "":
            return None
        return Peer.WITHOUT_IPV4 if self._lookup.isOnlyIpv6 else Peer.UNKNOWN_HOST

    def _connect(self) -> Peer | None:
        self._deadline = self._clock() + ANSWER_S
        self._connection = _Connection()
        return None if self._connection.begin(self._ip, self._port) else Peer.NOBODY

    def _converse(self, connection: _Connection) -> Peer | None:
        """Send the question when there is a connection, then listen."""
        if not self._isAsked:
            if not connection.isReady(POLL_S):
                return None
            if connection.isRefused():
                return Peer.NOBODY
            self._isAsked = True
            connection.ask(question())
        for piece in range(_MAX_PIECES):
            if not connection.isReady(POLL_S if piece == 0 else 0.0):
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
