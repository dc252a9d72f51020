"""What is said of the link, and what to do about it."""

from dataclasses import replace

import pytest

from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.slicer.heartbeat import LinkObservation, LinkState, judge, notInstalled

WELL = LinkObservation(
    "127.0.0.1:18944",
    isWanted=True,
    isOpen=True,
    silenceS=0.5,
    isHeard=True,
    peerVersion=PROTOCOL_VERSION,
)


@pytest.mark.parametrize(
    ("link", "state", "sentence", "remedy"),
    [
        (WELL, LinkState.CONNECTED, "Connected to the simulator at 127.0.0.1:18944", ""),
        (replace(WELL, isWanted=False), LinkState.OFF, "Not connected", "Connect"),
        (replace(WELL, isOpen=False), LinkState.ABSENT, "No simulator answers", "Start it"),
        (
            replace(WELL, isOpen=False, isListening=True),
            LinkState.ABSENT,
            "No simulator has connected",
            "--connect",
        ),
        (replace(WELL, isHeard=False), LinkState.GREETING, "waiting for its first", ""),
        (replace(WELL, silenceS=5.2), LinkState.STALE, "silent for 5 s", "restart"),
        (
            replace(WELL, isHeard=False, silenceS=5.0),
            LinkState.STALE,
            "no RASTrainer simulator",
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
    status = notInstalled()
    assert status.state is LinkState.NOT_INSTALLED
    assert "SlicerOpenIGTLink" in status.sentence
    assert "Extensions Manager" in status.remedy


def test_one_lost_heartbeat_is_no_reason_to_worry():
    assert judge(replace(WELL, silenceS=2.5)).state is LinkState.CONNECTED
