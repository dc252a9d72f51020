"""Tells from the first bytes of a peer whether it is a simulator, and if not, what it may be."""

from __future__ import annotations

from rastrainer.igtl.content import Status
from rastrainer.igtl.message import Message, pack
from rastrainer.igtl.stream import MessageReader
from rastrainer.protocol import Device
from rastrainer.slicer.finding import Peer

MOST_BYTES = 64 * 1024
"""What is listened to; a simulator's heartbeat comes among the first hundreds."""
MOST_STATUS_BYTES = 4096

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
        self._reader = MessageReader({Status.TYPE: MOST_STATUS_BYTES})

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
            if message.device == Device.SIM_SERVER:
                self.version = message.content.subcode
                return Peer.SIMULATOR
        if self._reader.refusal:
            return Peer.OTHER_OPENIGTLINK if self._reader.taken else Peer.OTHER_PROGRAM
        return Peer.OTHER_OPENIGTLINK if self._size > MOST_BYTES else None
