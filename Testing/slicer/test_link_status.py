"""The status line about the link, with its advice."""

from dataclasses import replace

import pytest

from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.slicer.link.link_status import (
    NOT_INSTALLED,
    LinkObservation,
    LinkState,
    Peer,
    ProbeResult,
    judge,
)

WELL = LinkObservation(
    "127.0.0.1:18944",
    isOpen=True,
    silenceS=0.5,
    hasHeartbeat=True,
    peerVersion=PROTOCOL_VERSION,
)


def found(peer):
    return replace(WELL, isOpen=False, finding=ProbeResult(peer))


@pytest.mark.parametrize(
    ("link", "state", "sentence", "remedy"),
    [
        (WELL, LinkState.CONNECTED, "Connected to the simulator at 127.0.0.1:18944", ""),
        (replace(WELL, address=""), LinkState.OFF, "Not connected", "Start and connect"),
        (replace(WELL, isOpen=False), LinkState.LOOKING, "Looking for a simulator at 127", ""),
        (
            replace(WELL, isOpen=False, finding=ProbeResult(Peer.SIMULATOR, "", PROTOCOL_VERSION)),
            LinkState.LOOKING,
            "Looking for a simulator",
            "",
        ),
        (found(Peer.UNREACHABLE), LinkState.ABSENT, "No simulator answers", "Start the simulator"),
        (found(Peer.UNKNOWN_HOST), LinkState.ABSENT, "no computer by that name", "IPv4"),
        (found(Peer.WITHOUT_IPV4), LinkState.ABSENT, "is an IPv6 address", "127.0.0.1"),
        (found(Peer.WEB_PAGE), LinkState.OTHER_PROGRAM, "is a web page (HTTP), not", "18944"),
        (found(Peer.ENCRYPTED), LinkState.OTHER_PROGRAM, "encrypted port (TLS)", "18944"),
        (found(Peer.SILENT), LinkState.OTHER_PROGRAM, "sends nothing", "18944"),
        (
            found(Peer.OTHER_OPENIGTLINK),
            LinkState.OTHER_PROGRAM,
            "is another OpenIGTLink program, not",
            "18944",
        ),
        (found(Peer.OTHER_PROGRAM), LinkState.OTHER_PROGRAM, "is another program, not", "18944"),
        (
            replace(
                WELL, isOpen=False, finding=ProbeResult(Peer.SIMULATOR, "", PROTOCOL_VERSION + 1)
            ),
            LinkState.WRONG_VERSION,
            f"version {PROTOCOL_VERSION + 1} of the protocol",
            "Update the module",
        ),
        (replace(WELL, hasHeartbeat=False), LinkState.GREETING, "waiting for its first", ""),
        (replace(WELL, silenceS=5.2), LinkState.STALE, "silent for 5 s", "restart"),
        (
            replace(WELL, hasHeartbeat=False, silenceS=5.0),
            LinkState.STALE,
            "not a RASTrainer simulator",
            "host and port",
        ),
        (
            replace(WELL, peerVersion=PROTOCOL_VERSION + 1),
            LinkState.WRONG_VERSION,
            f"version {PROTOCOL_VERSION + 1} of the protocol, this module {PROTOCOL_VERSION}",
            "Update the module",
        ),
        (
            replace(WELL, peerVersion=PROTOCOL_VERSION - 1),
            LinkState.WRONG_VERSION,
            f"version {PROTOCOL_VERSION - 1} of the protocol",
            "Update the simulator",
        ),
    ],
)
def test_each_state_has_its_sentence_and_its_remedy(link, state, sentence, remedy):
    status = judge(link)
    assert status.state is state
    assert sentence in status.sentence
    assert remedy in status.remedy


def test_a_missing_extension_is_named():
    status = NOT_INSTALLED
    assert status.state is LinkState.NOT_INSTALLED
    assert "SlicerOpenIGTLink" in status.sentence
    assert "Extensions Manager" in status.remedy


def test_a_single_lost_heartbeat_is_no_reason_to_worry():
    assert judge(replace(WELL, silenceS=2.5)).state is LinkState.CONNECTED
