"""The state of the simulator and its link, and who answers at an address, in words.

An open connection proves little: it may be half open, or lead to another program. The simulator
therefore sends a heartbeat every second, with the version of its protocol.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.slicer.translation import _


class Peer(str, Enum):
    """Programs that may answer at a port."""

    SIMULATOR = "simulator"
    UNREACHABLE = "unreachable"
    UNKNOWN_HOST = "unknown host"
    WITHOUT_IPV4 = "host without IPv4 address"
    SILENT = "silent"
    WEB_PAGE = "web page"
    ENCRYPTED = "encrypted"
    OTHER_OPENIGTLINK = "other OpenIGTLink program"
    OTHER_PROGRAM = "other program"


@dataclass(frozen=True)
class ProbeResult:
    """The program at an IPv4 address, with the protocol version of a simulator."""

    peer: Peer
    ip: str = ""
    version: int = 0


STALE_AFTER_S = 3.5
RECONNECT_AFTER_S = 10.0
"""Seconds of silence after which the link counts as stale, and after which it is reopened."""


class LinkState(str, Enum):
    """State of the link."""

    OFF = "off"
    NOT_INSTALLED = "not installed"
    LOOKING = "looking"
    ABSENT = "absent"
    OTHER_PROGRAM = "other program"
    GREETING = "greeting"
    CONNECTED = "connected"
    STALE = "stale"
    WRONG_VERSION = "wrong version"


@dataclass(frozen=True)
class LinkStatus:
    """The state of the link, one sentence about it, and one about what to do (may be empty)."""

    state: LinkState
    sentence: str
    remedy: str = ""

    @property
    def isConnected(self) -> bool:
        return self.state is LinkState.CONNECTED


NOT_INSTALLED = LinkStatus(
    LinkState.NOT_INSTALLED,
    _("The extension SlicerOpenIGTLink is not installed."),
    _("Install it in the Extensions Manager and restart Slicer."),
)


def _otherProgram(what: str) -> LinkStatus:
    sentence = _("What answers at {address} is {what}, not the OpenIGTLink port of a simulator.")
    return LinkStatus(
        LinkState.OTHER_PROGRAM,
        sentence.format(address="{address}", what=what),
        _("Enter the port that the simulator shows for OpenIGTLink: 18944 unless it has another."),
    )


_SILENT = _(
    "What answers at {address} accepts the connection and sends nothing: "
    "it is not the OpenIGTLink port of a simulator."
)
_FOUND = {
    Peer.SIMULATOR: LinkStatus(
        LinkState.CONNECTED, _("A RASTrainer simulator answers at {address}."), _("Press Connect.")
    ),
    Peer.UNREACHABLE: LinkStatus(
        LinkState.ABSENT,
        _("No simulator answers at {address}."),
        _("Start the simulator, or correct the host and port."),
    ),
    Peer.UNKNOWN_HOST: LinkStatus(
        LinkState.ABSENT,
        _("There is no computer by that name: {address}."),
        _("Correct the host, or enter its IPv4 address, such as 127.0.0.1."),
    ),
    Peer.WITHOUT_IPV4: LinkStatus(
        LinkState.ABSENT,
        _("Slicer connects by IPv4 only, and {address} is an IPv6 address."),
        _("Enter its IPv4 address; this computer's own is 127.0.0.1."),
    ),
    Peer.SILENT: replace(_otherProgram(""), sentence=_SILENT),
    Peer.WEB_PAGE: _otherProgram(_("a web page (HTTP)")),
    Peer.ENCRYPTED: _otherProgram(_("an encrypted port (TLS), such as that of a web page")),
    Peer.OTHER_OPENIGTLINK: _otherProgram(_("another OpenIGTLink program")),
    Peer.OTHER_PROGRAM: _otherProgram(_("another program")),
}
"""The status of an address, by the program that answers there."""


@dataclass
class LinkObservation:
    """The observed state of a connection.

    The `address` is as the user gave it, empty if no connection is wanted. `silenceS` are seconds
    since the last heartbeat, or since the TCP connection was opened, without those in which Slicer
    itself was held up; `hasHeartbeat` says that one has come over this connection.
    """

    address: str = ""
    isInstalled: bool = True
    finding: ProbeResult | None = None
    isOpen: bool = False
    silenceS: float = 0.0
    hasHeartbeat: bool = False
    peerVersion: int | None = None


def judge(link: LinkObservation) -> LinkStatus:
    if not link.address:
        return LinkStatus(LinkState.OFF, _("Not connected."), _("Press Start and connect."))
    if not link.isInstalled:
        return NOT_INSTALLED
    if not link.isOpen:
        status = lookingAt(link.address)
        if link.finding is not None:
            found = judgeFinding(link.finding, link.address)
            status = status if found.isConnected else found
        return status
    if link.peerVersion not in (None, PROTOCOL_VERSION):
        return _wrongVersion(link.peerVersion)
    if link.silenceS > STALE_AFTER_S and link.hasHeartbeat:
        return LinkStatus(
            LinkState.STALE,
            _("The simulator has been silent for {seconds:.0f} s.").format(seconds=link.silenceS),
            _("Wait for it to come back; if it does not, restart the simulator. No touch is lost."),
        )
    if link.silenceS > STALE_AFTER_S:
        sentence = _("What answers at {address} is not a RASTrainer simulator.")
        remedy = _("Correct the host and port.")
        return LinkStatus(LinkState.STALE, sentence.format(address=link.address), remedy)
    if not link.hasHeartbeat:
        sentence = _("{address} answers; waiting for its first heartbeat.")
        return LinkStatus(LinkState.GREETING, sentence.format(address=link.address))
    sentence = _("Connected to the simulator at {address}.")
    return LinkStatus(LinkState.CONNECTED, sentence.format(address=link.address))


def judgeFinding(finding: ProbeResult, address: str) -> LinkStatus:
    """Return in words who answers at an address where no connection is wanted."""
    if finding.peer is Peer.SIMULATOR and finding.version != PROTOCOL_VERSION:
        return _wrongVersion(finding.version)
    found = _FOUND[finding.peer]
    return replace(found, sentence=found.sentence.format(address=address))


def lookingAt(address: str) -> LinkStatus:
    sentence = _("Looking for a simulator at {address}.").format(address=address)
    return LinkStatus(LinkState.LOOKING, sentence)


def _wrongVersion(theirs: int) -> LinkStatus:
    return LinkStatus(
        LinkState.WRONG_VERSION,
        _("The simulator speaks version {theirs} of the protocol, this module {ours}.").format(
            theirs=theirs, ours=PROTOCOL_VERSION
        ),
        _("Update the module.") if theirs > PROTOCOL_VERSION else _("Update the simulator."),
    )
