"""pyigtl, an independent implementation, as client and as server: every type that it has.

It has no COMMAND and no STATUS; those are made here from its base class, which packs the header,
the metadata and the checksum.
"""

import json
import signal
import struct
import time

import numpy as np
import pyigtl
import pytest
from pyigtl.comm import OpenIGTLinkBase
from pyigtl.messages import MessageBase, message_type_to_class_constructor

from rastrainer.igtl.client import Client
from rastrainer.igtl.content import Command, Point, Points, Status, String
from rastrainer.igtl.message import Message
from rastrainer_simulator.state import TrainingState
from rastrainer_simulator.trial_state import TouchState
from Testing.domain.igtl.sent_pose import transform_of
from Testing.free_port import free_port
from Testing.simulator.net.igtl.servers import at_rest

MATRIX = np.array([[0, -1, 0, 10.5], [1, 0, 0, -20.25], [0, 0, 1, 300.125], [0, 0, 0, 1]])
TRANSFORM = transform_of(MATRIX)
TIP = np.array([[0, -1, 0, 0.5], [1, 0, 0, -0.25], [0, 0, 1, 0.125], [0, 0, 0, 1]])
TOUCHES = (TouchState("1", (0.5, -0.25, 0.125), 1, 1), TouchState("2", (0.1, 0.2, 0.3), 2, 2))


class CommandMessage(MessageBase):
    def __init__(self, number=0, name="", body=""):
        super().__init__(device_name="command")
        self._message_type = "COMMAND"
        self._valid_message = True
        self.number, self.name, self.body = number, name, body

    def _pack_content(self):
        body = self.body.encode()
        return struct.pack(">I128sHI", self.number, self.name.encode(), 3, len(body)) + body

    def _unpack_content(self, content):
        self.number, name, _encoding, _size = struct.unpack(">I128sHI", content[:138])
        self.name, self.body = name.rstrip(b"\0").decode(), content[138:].decode()


class StatusMessage(MessageBase):
    def __init__(self):
        super().__init__(device_name="Device")
        self._message_type = "STATUS"
        self._valid_message = True
        self.code, self.subcode, self.message = 1, 42, "well"

    def _pack_content(self):
        return struct.pack(">HQ20s", self.code, self.subcode, b"") + self.message.encode() + b"\0"

    def _unpack_content(self, content):
        self.code, self.subcode, _name = struct.unpack(">HQ20s", content[:30])
        self.message = content[30:].rstrip(b"\0").decode()


@pytest.fixture(autouse=True)
def more_types(monkeypatch):
    for name, kind in [
        ("COMMAND", CommandMessage),
        ("RTS_COMMAND", CommandMessage),
        ("STATUS", StatusMessage),
    ]:
        monkeypatch.setitem(message_type_to_class_constructor, name, kind)


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


@pytest.fixture
def pyigtl_server():
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    server = pyigtl.OpenIGTLinkServer(free_port())
    yield server
    server.communication_thread_stop_requested = True
    server.stop()
    for number, handler in handlers.items():
        signal.signal(number, handler)


@pytest.mark.parametrize("header_version", [1, 2])
def test_messages_sent_by_pyigtl_are_read(plain_server, connected, header_version):
    client = connected(plain_server.port)
    sent = [
        pyigtl.TransformMessage(MATRIX, device_name="Probe"),
        pyigtl.StringMessage("touch point 3", device_name="Note"),
        pyigtl.PointMessage([[1.5, -2, 3.25]], names=["7"], device_name="Points"),
        StatusMessage(),
        CommandMessage(4711, "Hello", "{}"),
    ]
    for message in sent:
        message.header_version = header_version
        client.send_message(message)
    assert [message.content for message in plain_server.handler.wait_for_messages(5)] == [
        TRANSFORM,
        String("touch point 3"),
        Points((Point("7", (1.5, -2, 3.25)),)),
        Status(1, 42, "", "well"),
        Command(4711, "Hello", "{}"),
    ]


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
    heartbeat = client.wait_for_message("SimServer", 60)
    assert json.loads(heartbeat.message)["protocolVersion"] == heartbeat.subcode


def test_pyigtl_gets_the_answer_to_its_command_with_its_metadata(link_server, connected):
    client = connected(link_server.port)
    command = CommandMessage(5, "ListTasks", "{}")
    command.header_version = 2
    client.send_message(command)
    reply = client.wait_for_message("command", 60)
    assert (reply.number, reply.name, reply.body) == (5, "ListTasks", '{"did": "ListTasks"}')
    assert reply.metadata == {"Status": "SUCCESS"}


def test_our_client_and_a_pyigtl_server_understand_each_other(pyigtl_server):
    with Client(port=pyigtl_server.port) as client:
        client.send(Message("Probe", TRANSFORM, {"seq": "1"}))
        client.send(Message("Points", Points((Point("7", (1, 2, 3)),))))
        probe = pyigtl_server.wait_for_message("Probe", 60)
        np.testing.assert_array_equal(probe.matrix, MATRIX)
        assert pyigtl_server.wait_for_message("Points", 60).names == ["7"]
        pyigtl_server.send_message(pyigtl.StringMessage("hello", device_name="Note"))
        assert client.wait_for("Note", timeout=60).content == String("hello")
