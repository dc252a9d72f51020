"""Who answers at an address, in words, and what to do about it."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

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
class Finding:
    """Who answered.

    Attributes:
        peer: who it is.
        ip: address that was asked, four numbers; empty where the host has none.
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
            "What answers at {address} takes the connection and says nothing: "
            "it is not the OpenIGTLink port of a simulator."
        ).format(address=address)
    return _(
        "What answers at {address} is {what}, not the OpenIGTLink port of a simulator."
    ).format(address=address, what=_nameOf(peer))


def remedyOf(peer: Peer) -> str:
    """Return what to do about it; nothing where it is a simulator."""
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
