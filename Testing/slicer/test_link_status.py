"""The status line about the link, with its advice."""

from dataclasses import replace

import pytest

from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.slicer.link.link_status import LinkObservation, LinkState, Peer, ProbeResult, judge

WELL = LinkObservation("127.0.0.1:18944", True, None, True, 0.5, True, PROTOCOL_VERSION)


def found(peer, version=0):
    return {"isOpen": False, "finding": ProbeResult(peer, "", version)}


@pytest.mark.parametrize(
    ("changes", "state", "sentence", "remedy"),
    [
        ({}, "CONNECTED", "Connected to the simulator at 127.0.0.1:18944", ""),
        ({"silenceS": 2.5}, "CONNECTED", "Connected", ""),
        ({"address": ""}, "OFF", "Not connected", "Start and connect"),
        ({"isOpen": False}, "LOOKING", "Looking for a simulator at 127", ""),
        (found(Peer.SIMULATOR, PROTOCOL_VERSION), "LOOKING", "Looking for a simulator", ""),
        (found(Peer.UNREACHABLE), "ABSENT", "No simulator answers at 127", "Start the simulator"),
        (found(Peer.UNKNOWN_HOST), "ABSENT", "no computer by that name", "IPv4"),
        (found(Peer.WITHOUT_IPV4), "ABSENT", "is an IPv6 address", "127.0.0.1"),
        (found(Peer.WEB_PAGE), "OTHER_PROGRAM", "127.0.0.1:18944 is a web page (HTTP)", "18944"),
        (found(Peer.ENCRYPTED), "OTHER_PROGRAM", "encrypted port (TLS)", "18944"),
        (found(Peer.SILENT), "OTHER_PROGRAM", "sends nothing", "18944"),
        (found(Peer.OTHER_OPENIGTLINK), "OTHER_PROGRAM", "another OpenIGTLink program", "18944"),
        (found(Peer.OTHER_PROGRAM), "OTHER_PROGRAM", "is another program, not", "18944"),
        (found(Peer.SIMULATOR, 99), "WRONG_VERSION", "version 99 of", "Update the module"),
        ({"hasHeartbeat": False}, "GREETING", "waiting for its first", ""),
        ({"silenceS": 5.2}, "STALE", "silent for 5 s", "restart"),
        ({"hasHeartbeat": False, "silenceS": 5.0}, "STALE", "not a RASTrainer", "host and port"),
        ({"peerVersion": 99}, "WRONG_VERSION", "version 99 of the protocol", "Update the module"),
        ({"peerVersion": 0}, "WRONG_VERSION", "version 0 of the protocol", "Update the simulator"),
    ],
)
def test_each_state_has_its_sentence_and_its_remedy(changes, state, sentence, remedy):
    status = judge(replace(WELL, **changes))
    assert status.state is LinkState[state]
    assert sentence in status.sentence
    assert remedy in status.remedy
