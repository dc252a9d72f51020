"""The connector connects to simulators only: anything else could crash Slicer."""

import time

import pytest

from rastrainer.slicer.link.link_status import LinkState
from rastrainer_headless.connector import RETRY_PERIOD_S
from Testing.slicer.simulator_double import SimulatorDouble, run_link_until
from Testing.slicer.strangers import is_silent, replies_with, says, stranger

HTTP = b"HTTP/1.1 408 Request Time-out\r\n"
WEB_SERVER = b"HTTP/1.1 400 Bad Request\r\n\r\n"
SILENT = "accepts the connection and sends nothing"
WEB_PAGE = "is a web page (HTTP), not the OpenIGTLink port of a simulator"


def connect(link, simulator):
    link.connectTo(port=simulator.port)
    run_link_until(link, lambda: link.status.state is LinkState.CONNECTED)


def run_until_status_contains(link, words):
    """Wait until the link reports it; a server that is late counts as silent at first."""
    run_link_until(link, lambda: words in link.status.sentence)


def test_a_web_page_is_named_and_never_connected_to_and_a_simulator_after_it_is(link, clock):
    with stranger(replies_with(WEB_SERVER)) as port:
        link.connectTo(port=port)
        run_until_status_contains(link, f"What answers at 127.0.0.1:{port} {WEB_PAGE}")
        assert link.status.state is LinkState.OTHER_PROGRAM
        assert "18944" in link.status.remedy
        assert link.connector is None
    with SimulatorDouble(port=port):
        clock.ahead += 5.0
        run_link_until(link, lambda: link.status.state is LinkState.CONNECTED)


@pytest.mark.parametrize("is_cleared", [False, True], ids=["lost", "cleared scene"])
def test_after_a_loss_or_in_a_cleared_scene_the_peer_is_recognized_again(link, scene, is_cleared):
    with SimulatorDouble() as simulator:
        connect(link, simulator)
        if is_cleared:
            scene.Clear(False)
    with stranger(replies_with(WEB_SERVER), simulator.port):
        run_until_status_contains(link, WEB_PAGE)
        assert link.status.state is LinkState.OTHER_PROGRAM
        assert link.connector is None or not is_cleared


def test_another_program_at_the_port_during_a_stall_is_not_connected_to(link):
    with SimulatorDouble() as simulator:
        connect(link, simulator)
    with stranger(says(HTTP), simulator.port):
        time.sleep(5 * RETRY_PERIOD_S)  # The connector's own thread continues all the time.
        run_link_until(link, lambda: link.status.state is LinkState.OTHER_PROGRAM)


def test_after_a_half_open_connection_the_peer_is_recognized_again(link, clock):
    simulator = SimulatorDouble()
    connect(link, simulator)
    simulator.stop_listening()
    with stranger(is_silent, simulator.port):
        simulator.beats = False
        run_link_until(link, lambda: clock.skip_ahead() and SILENT in link.status.sentence)
        assert link.status.state is LinkState.OTHER_PROGRAM
    simulator.close()


def test_a_connection_is_tested_without_being_made(link, simulator, clock):
    clock.stop()
    received = []
    asked = link.testConnection("localhost", simulator.port, received.append)
    assert asked.state is LinkState.LOOKING
    run_link_until(link, lambda: received)
    assert received[0].state is LinkState.CONNECTED
    assert f"A RASTrainer simulator answers at localhost:{simulator.port}" in received[0].sentence
    with stranger(replies_with(WEB_SERVER)) as port:
        link.testConnection("127.0.0.1", port, received.append)
        run_link_until(link, lambda: len(received) == 2)
    assert received[1].state is LinkState.OTHER_PROGRAM
    assert WEB_PAGE in received[1].sentence
    assert link.status.state is LinkState.OFF
    assert link.connector is None
