"""Looks up an address and tests once what answers there, without blocking.

Slicer's connector must never meet anything but a simulator: OpenIGTLink's client takes any bytes
for a message, and crashes Slicer at the sizes that it reads from, say, a web page.
"""

from __future__ import annotations

import contextlib
import socket
import time
from collections.abc import Callable

from rastrainer.igtl.content import Status
from rastrainer.igtl.message import Message, MessageReader, pack
from rastrainer.protocol import DeviceName
from rastrainer.slicer.background_work import Job
from rastrainer.slicer.link.link_status import Peer, ProbeResult

MAX_BYTES = 64 * 1024
"""Most bytes read; a simulator's heartbeat comes among the first hundreds."""
MAX_STATUS_BYTES = 4096

_HEADERS = (b"\0\1", b"\0\2")
_WEB_PAGES = (b"HTTP/", b"<")
_TLS_ALERT = b"\x15\x03"


class PeerRecognition:
    """Takes the bytes of one peer as they come; `peer` is None until it is certain who it is."""

    def __init__(self) -> None:
        self.peer: Peer | None = None
        self.version = 0
        self._start = b""
        self._size = 0
        self._reader = MessageReader({Status.TYPE: MAX_STATUS_BYTES})

    def feed(self, data: bytes) -> None:
        self._size += len(data)
        self._start += data[: max(0, 8 - len(self._start))]
        known = (*_HEADERS, *_WEB_PAGES, _TLS_ALERT)
        if self._start.startswith(_WEB_PAGES):
            self.peer = Peer.WEB_PAGE
        elif self._start.startswith(_TLS_ALERT):
            self.peer = Peer.ENCRYPTED
        elif not any(sign[: len(self._start)] == self._start[: len(sign)] for sign in known):
            self.peer = Peer.OTHER_PROGRAM
        else:
            for message in self._reader.feed(data):
                # The reader lets nothing but STATUS through.
                if message.device == DeviceName.SIM_SERVER and isinstance(message.content, Status):
                    self.peer, self.version = Peer.SIMULATOR, message.content.subcode
                    return
            if self._reader.refusal:
                self.peer = self.giveUp()
            elif self._size > MAX_BYTES:
                self.peer = Peer.OTHER_OPENIGTLINK

    def giveUp(self) -> Peer:
        """Return who it is if nothing more comes."""
        if self.peer is not None:
            return self.peer
        if not self._size:
            return Peer.SILENT
        return Peer.OTHER_OPENIGTLINK if self._reader.taken else Peer.OTHER_PROGRAM


def _findAddress(host: str) -> str | Peer:
    """Return the IPv4 address of a host, else why there is none.

    OpenIGTLink's client speaks IPv4 alone, so other addresses are useless.
    """
    if ":" in host:
        return Peer.WITHOUT_IPV4
    for family in (socket.AF_INET, socket.AF_INET6):
        with contextlib.suppress(OSError, UnicodeError):
            ip = socket.getaddrinfo(host, None, family, socket.SOCK_STREAM)[0][4][0]
            return str(ip) if family is socket.AF_INET else Peer.WITHOUT_IPV4
    return Peer.UNKNOWN_HOST


LOOKUP_S = 5.0
ANSWER_S = 3.0
"""How long to look up a name, and how long to wait for an answer."""
POLL_S = 0.005
"""How long each poll waits: in Slicer other threads run only while the main thread waits."""
_LONGEST_S = 20.0
"""When a probe's thread ends at the latest, if the network does not even say that it is closed."""
_PIECE_BYTES = 4096


class Probe:
    """One question, asked by a thread; `process` is called until it returns a finding."""

    def __init__(self, host: str, port: int, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._ip = ""
        self._deadline = clock() + LOOKUP_S
        self._isAsked = False
        self._recognition = PeerRecognition()
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_STREAM)
        self._socket.settimeout(_LONGEST_S)
        self._job = Job(lambda: self._ask(host, port))

    def process(self) -> ProbeResult | None:
        """Let the thread run for some milliseconds; return who answers once that is known."""
        self._job.thread.join(POLL_S)
        if self._job.isDone:
            peer = self._job.outcome.result()
        elif self._clock() > self._deadline:
            peer = Peer.UNREACHABLE if self._ip else Peer.UNKNOWN_HOST
            if self._isAsked:
                peer = self._recognition.giveUp()
            self.close()
        else:
            return None
        return ProbeResult(peer, self._ip, self._recognition.version)

    def close(self) -> None:
        self._job.leave()
        with contextlib.suppress(OSError):  # It may not be connected.
            self._socket.shutdown(socket.SHUT_RDWR)

    def _ask(self, host: str, port: int) -> Peer:
        """Return who answers a STATUS.

        Slicer itself begins each connection with one: it does no harm to any OpenIGTLink program.
        Its text ends as the request of a browser does, so that a web server answers, too.
        """
        status = Status(Status.OK, message="Who is there?\r\n\r\n")
        question = pack(Message("RASTrainer", status, {"client": "connection test"}))
        with self._socket:
            found = _findAddress(host)
            if isinstance(found, Peer):
                return found
            self._ip, self._deadline = found, self._clock() + ANSWER_S
            try:
                self._socket.connect((found, port))
            except OSError:
                return Peer.UNREACHABLE
            self._isAsked = True
            with contextlib.suppress(OSError):  # Earlier bytes from the peer may still be read.
                self._socket.send(question)
            with contextlib.suppress(OSError):
                while self._recognition.peer is None and (data := self._socket.recv(_PIECE_BYTES)):
                    self._recognition.feed(data)
        return self._recognition.giveUp()
