"""pyigtl, an independent implementation, reads what is published, and sends what is read."""

import json
import time

import numpy as np
import pyigtl
import pytest
from pyigtl.comm import OpenIGTLinkBase

from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.trial_state import TouchState
from Testing.domain.igtl.sent_pose import transform_of
from Testing.simulator.net.igtl.servers import at_rest

MATRIX = np.array([[0, -1, 0, 10.5], [1, 0, 0, -20.25], [0, 0, 1, 300.125], [0, 0, 0, 1]])
TRANSFORM = transform_of(MATRIX)
TIP = np.array([[0, -1, 0, 0.5], [1, 0, 0, -0.25], [0, 0, 1, 0.125], [0, 0, 0, 1]])
TOUCHES = (TouchState("1", (0.5, -0.25, 0.125), 1, 1), TouchState("2", (0.1, 0.2, 0.3), 2, 2))


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """Let pyigtl wait until its peer takes a message: it gives up after 10 ms, in the middle."""
    send = OpenIGTLinkBase._send_queued_message_from_socket

    def send_patiently(endpoint, peer):
        impatience = peer.gettimeout()
        peer.settimeout(60)
        is_sent = send(endpoint, peer)
        peer.settimeout(impatience)
        return is_sent

    monkeypatch.setattr(OpenIGTLinkBase, "_send_queued_message_from_socket", send_patiently)


@pytest.fixture
def connected():
    """Makes pyigtl clients of a port, and ends them."""
    clients = []

    def connect(port):
        clients.append(pyigtl.OpenIGTLinkClient("127.0.0.1", port))
        return clients[-1]

    yield connect
    for client in clients:
        client.stop()


def test_pyigtl_reads_everything_that_is_published(link_server, connected):
    training = TrainingState(trial_id="id-1", touches=TOUCHES)
    link_server.simulated.latest = at_rest(tool_tip_to_world=TIP, training=training)
    client = connected(link_server.port)
    while not link_server.server.clients:
        time.sleep(0.01)
    link_server.publish(at_rest(sim_time=1.0, tool_tip_to_world=TIP, training=training))
    tip = client.wait_for_message("ToolTipToWorld", 60)
    expected = [[0, -1, 0, 500], [1, 0, 0, -250], [0, 0, 1, 125], [0, 0, 0, 1]]
    np.testing.assert_array_equal(tip.matrix, expected)
    assert tip.metadata["TransformStatus"] == "OK"
    points = client.wait_for_message("CapturedPoints", 60)
    assert points.names == ["1", "2"]
    np.testing.assert_allclose(points.positions, [[500, -250, 125], [100, 200, 300]], rtol=1e-7)
    state = client.wait_for_message("SimState", 60)
    assert json.loads(state.string)["trialId"] == "id-1"
    assert client.wait_for_message("Link7ToWorld", 60) is not None
    client.send_message(pyigtl.TransformMessage(TIP, device_name="Probe"))
    np.testing.assert_array_equal(client.wait_for_message("Probe", 60).matrix, TIP)
