"""What answers at an address, recognized from its first bytes, and what to do about it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from rastrainer.igtl.content import Status
from rastrainer.igtl.message import Message, MessageReader, pack
from rastrainer.protocol import DeviceName
from rastrainer.slicer.translation import _


class Peer(str, Enum):
    """Who may answer at a port."""

    SIMULATOR = "simulator"
    NOBODY = "nobody"
    UNKNOWN_HOST = "unknown host"
    SILENT = "silent"
    WEB_PAGE = "web page"
    ENCRYPTED = "encrypted"
    OTHER_OPENIGTLINK = "other OpenIGTLink program"
    OTHER_PROGRAM = "other program"


@dataclass(frozen=True)
class ProbeResult:
    """Who answered.

    Attributes:
        peer: who it is.
        ip: tested IPv4 address; empty if the host has none.
        version: of the simulator's protocol; 0 where it is no simulator.
    """

    peer: Peer
    ip: str = ""
    version: int = 0


def sentenceOf(peer: Peer, address: str) -> str:
    """Return who answers at the address, such as `127.0.0.1:18944`, in a sentence."""
    if peer is Peer.NOBODY:
        return _("No simulator answers at {address}.").format(address=address)
    if peer is Peer.UNKNOWN_HOST:
        return _("There is no computer of that name: {address}.").format(address=address)
    if peer is Peer.SIMULATOR:
        return _("A RASTrainer simulator answers at {address}.").format(address=address)
    if peer is Peer.SILENT:
        return _(
            "What answers at {address} accepts the connection and sends nothing: "
            "it is not the OpenIGTLink port of a simulator."
        ).format(address=address)
    return _(
        "What answers at {address} is {what}, not the OpenIGTLink port of a simulator."
    ).format(address=address, what=_nameOf(peer))


def remedyOf(peer: Peer) -> str:
    """Return what to do about it; empty if it is a simulator."""
    if peer is Peer.NOBODY:
        return _("Start the simulator, or correct the host and port.")
    if peer is Peer.UNKNOWN_HOST:
        return _("Correct the host, or enter its IPv4 address, such as 127.0.0.1.")
    if peer is Peer.SIMULATOR:
        return ""
    return _(
        "Enter the port that the simulator names for OpenIGTLink: 18944 unless it has another."
    )


def _nameOf(peer: Peer) -> str:
    if peer is Peer.WEB_PAGE:
        return _("a web page (HTTP)")
    if peer is Peer.ENCRYPTED:
        return _("an encrypted port (TLS), such as that of a web page")
    if peer is Peer.OTHER_OPENIGTLINK:
        return _("another OpenIGTLink program")
    return _("another program")


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
