"""The connection test tells what answers at an address."""

import socket

import pytest

from rastrainer.igtl.content import Status
from rastrainer.protocol import PROTOCOL_VERSION, Device
from rastrainer.slicer.heartbeat import LinkState
from rastrainer.slicer.probe import probe
from Testing.slicer.simulator_double import SimulatorDouble


@pytest.mark.parametrize(
    ("version", "state"),
    [
        (PROTOCOL_VERSION, LinkState.CONNECTED),
        (PROTOCOL_VERSION + 1, LinkState.WRONG_VERSION),
    ],
)
def test_a_simulator_is_recognized_with_its_version(version, state):
    def respond(_name, _arguments):
        simulator.send(Device.SIM_SERVER, Status(Status.OK, subcode=version))
        return {}

    with SimulatorDouble(respond) as simulator:
        assert probe("127.0.0.1", simulator.port).state is state


def test_nobody_at_home_is_told():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        port = listener.getsockname()[1]
    assert probe("127.0.0.1", port, 0.2).state is LinkState.ABSENT


def test_another_program_is_not_taken_for_a_simulator():
    with socket.create_server(("127.0.0.1", 0)) as listener:
        status = probe("127.0.0.1", listener.getsockname()[1], 0.2)
    assert "no RASTrainer simulator" in status.sentence
