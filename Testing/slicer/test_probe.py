"""Which server answers at an address is probed, without ever waiting for it."""

import socket
import threading

import pytest

from rastrainer.igtl.content import String, Transform
from rastrainer.igtl.message import Message, pack
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer.slicer.link.link_status import Peer, ProbeResult
from rastrainer.slicer.link.probe import ANSWER_S, LOOKUP_S, Probe
from Testing.free_port import free_port
from Testing.slicer.simulator_double import SimulatorDouble, wait_until
from Testing.slicer.strangers import (
    floods,
    is_silent,
    replies_with,
    says,
    stranger,
    trickles,
)

TEXT = pack(Message("Note", String("from another program")))
POSE = pack(Message("Tool", Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0))))


def ask(host, port):
    # Its clock stands still, however slow a busy machine is.
    probe = Probe(host, port, lambda: 0.0)
    found = []
    wait_until(lambda: found.append(probe.process()) or found[-1], lambda: None)
    return found[-1]


def test_a_simulator_is_recognized_with_its_version_and_an_unused_port_reported():
    with SimulatorDouble(version=PROTOCOL_VERSION + 1) as simulator:
        found = ask("localhost", simulator.port)
        assert found == ProbeResult(Peer.SIMULATOR, "127.0.0.1", PROTOCOL_VERSION + 1)
        assert simulator.commands == []
    assert ask("127.0.0.1", free_port()) == ProbeResult(Peer.UNREACHABLE, "127.0.0.1")


@pytest.mark.parametrize(
    ("behavior", "peer"),
    [
        (says(b"SSH-2.0-OpenSSH_9.2p1\r\n"), Peer.OTHER_PROGRAM),
        (replies_with(b"HTTP/1.1 400 Bad Request\r\n\r\n"), Peer.WEB_PAGE),
        (replies_with(b"\x15\x03\x01\0\2\2\x46"), Peer.ENCRYPTED),
        (replies_with(b""), Peer.SILENT),
        (replies_with(TEXT), Peer.OTHER_OPENIGTLINK),
        (floods(POSE), Peer.OTHER_OPENIGTLINK),
        (floods(b"\0\2STRING" + 56 * b"\xff"), Peer.OTHER_PROGRAM),
    ],
)
def test_a_peer_other_than_a_simulator_is_recognized_by_what_it_sends(behavior, peer):
    with stranger(behavior) as port:
        assert ask("127.0.0.1", port).peer is peer


@pytest.mark.parametrize(
    ("behavior", "heard", "peer"),
    [
        (is_silent, 0, Peer.SILENT),
        (says(TEXT), len(TEXT), Peer.OTHER_OPENIGTLINK),
        (trickles(b"\0\2STRING"), 1, Peer.OTHER_PROGRAM),
    ],
)
def test_the_probe_does_not_wait_forever_for_a_silent_network(behavior, heard, peer):
    now = [0.0]
    with stranger(behavior) as port:
        probe = Probe("127.0.0.1", port, lambda: now[-1])
        wait_until(lambda: probe._isAsked and probe._recognition._size >= heard, probe.process)
        now.append(ANSWER_S + 1.0)
        assert probe.process().peer is peer


def test_a_name_lookup_that_takes_too_long_is_given_up(monkeypatch):
    answers, now = threading.Event(), [0.0]

    def look_up(*_):
        answers.wait(60)
        raise socket.gaierror

    monkeypatch.setattr("rastrainer.slicer.link.probe.socket.getaddrinfo", look_up)
    probe = Probe("a-slow-computer", 18944, lambda: now[-1])
    assert probe.process() is None
    now.append(LOOKUP_S + 1.0)
    assert probe.process() == ProbeResult(Peer.UNKNOWN_HOST)
    answers.set()


@pytest.mark.parametrize("host", ["nowhere.invalid", "a" * 300])
def test_a_host_without_an_address_is_reported(host):
    assert ask(host, 18944) == ProbeResult(Peer.UNKNOWN_HOST)


@pytest.mark.parametrize("host", ["[::1]", "an-ipv6-computer"])
def test_an_address_of_ipv6_is_named_as_such(host, monkeypatch):
    def look_up(_host, _port, family, _kind):
        if family is not socket.AF_INET6:
            raise socket.gaierror
        return [(None, None, None, None, ("2001:db8::7", 0, 0, 0))]

    monkeypatch.setattr("rastrainer.slicer.link.probe.socket.getaddrinfo", look_up)
    assert ask(host, 18944) == ProbeResult(Peer.WITHOUT_IPV4)


def test_probing_leaves_no_socket_open():
    with stranger(is_silent) as port:
        probe = Probe("127.0.0.1", port)
        probe.process()
        probe.close()
        probe.close()
        probe._job.thread.join(60)
        assert probe._socket.fileno() == -1
