"""The stand-in of the connector behaves as `vtkMRMLIGTLConnectorNode` was measured to behave."""

import struct

import pytest
import vtk

from rastrainer.igtl.content import Point, Points, Status, String
from rastrainer.igtl.message import Message, crc64, pack
from rastrainer_headless.connector import CrashError, HeadlessCommand, HeadlessConnector
from Testing.domain.igtl.sent_pose import transform_of
from Testing.slicer.crashes import take_crashes
from Testing.slicer.simulator_double import SimulatorDouble, wait_until

SHIFT = ((1, 0, 0, 10), (0, 1, 0, 20), (0, 0, 1, 30), (0, 0, 0, 1))


@pytest.fixture
def connector(scene, simulator):
    connector = started_connector(scene, simulator)
    yield connector
    connector.Stop()


def started_connector(scene, simulator):
    connector = HeadlessConnector()
    scene.AddNode(connector)
    connector.SetTypeClient("127.0.0.1", simulator.port)
    assert connector.Start() == 1
    wait_until(lambda: connector.GetState() == connector.StateConnected, lambda: None)
    wait_until(lambda: simulator.peer_count == 1, lambda: None)
    return connector


def wait_for(connector, condition):
    wait_until(condition, connector.PeriodicProcess)


def sent(connector, name, content="{}", timeout=60.0):
    command = HeadlessCommand()
    command.SetName(name)
    command.SetCommandContent(content)
    command.SetTimeoutSec(timeout)
    connector.SendCommand(command)
    return command


def incoming(connector, name):
    nodes = map(connector.GetIncomingMRMLNode, range(connector.GetNumberOfIncomingMRMLNodes()))
    return next((node for node in nodes if node is not None and node.GetName() == name), None)


def point_list(count):
    return Points(tuple(Point(str(i + 1), (float(i), 0.0, 0.0)) for i in range(count)))


def empty_list_without_metadata(device):
    """Our own codec refuses to write this."""
    header = pack(Message(device, Points(()), {"a": "b"}))[:42]
    body = bytes.fromhex("000c 0000 00000000 00000000")
    return header + struct.pack(">QQ", len(body), crc64(body)) + body


def count_events(node, event):
    events = []
    node.AddObserver(event, lambda *_: events.append(event))
    return events


def waiting(connector):
    """How much has arrived that is not yet processed; no other class needs this."""
    return len(connector._commands) + len(connector._latest)


def received_commands(connector):
    names = []

    def keep(_caller, _event, command):
        names.append((command.GetName(), command.GetCommandContent()))

    keep.CallDataType = vtk.VTK_OBJECT
    connector.AddObserver(connector.CommandReceivedEvent, keep)
    return names


def test_metadata_stays_on_the_node_and_status_keys_also_without_prefix(connector, simulator):
    simulator.send("T", transform_of(SHIFT), {"seq": "1", "TransformStatus": "OK"})
    wait_for(connector, lambda: incoming(connector, "T"))
    simulator.send("T", transform_of(SHIFT), {"other": "2"})
    node = incoming(connector, "T")
    wait_for(connector, lambda: node.GetAttribute("OpenIGTLink.other") == "2")
    assert node.GetAttribute("OpenIGTLink.seq") == "1"
    assert node.GetAttribute("TransformStatus") == "OK"


def test_a_list_is_adopted_and_an_empty_one_clears_it_only_with_metadata(connector, simulator):
    ours = connector.GetScene().AddNewNodeByClass("vtkMRMLMarkupsFiducialNode", "CapturedPoints")
    ours.CreateDefaultDisplayNodes()
    ours.GetDisplayNode().SetGlyphScale(7.0)
    simulator.send("CapturedPoints", point_list(3))
    wait_for(connector, lambda: incoming(connector, "CapturedPoints"))
    node = incoming(connector, "CapturedPoints")
    # A node of that name and class is adopted, with its display.
    assert node is ours
    assert node.GetDisplayNode().GetGlyphScale() == 7.0
    simulator.send_bytes(empty_list_without_metadata("CapturedPoints"))
    simulator.send("Later", String("x"))
    wait_for(connector, lambda: incoming(connector, "Later"))
    assert node.GetNumberOfControlPoints() == 3
    simulator.send("CapturedPoints", Points(()), {"seq": "2"})
    wait_for(connector, lambda: node.GetNumberOfControlPoints() == 0)


def test_the_latest_message_of_each_device_in_a_burst_wins(connector, simulator, scene):
    node = scene.AddNewNodeByClass("vtkMRMLTextNode", "SimState")
    changes = count_events(node, node.TextModifiedEvent)
    for number in range(100):
        simulator.send("SimState", String(str(number)))
    simulator.send("Last", String("x"))
    wait_until(lambda: waiting(connector) == 2, lambda: None)
    connector.PeriodicProcess()
    assert node.GetText() == "99"
    assert len(changes) == 1


def test_commands_come_first_and_in_order_and_none_is_lost(connector, simulator):
    commands = received_commands(connector)
    simulator.send("SimState", String("x"))
    order = []
    scene = connector.GetScene()
    scene.AddObserver(scene.NodeAddedEvent, lambda *_: order.append(len(commands)))
    for number in range(500):
        simulator.send_command("TrialCompleted", {"number": number})
    wait_until(lambda: waiting(connector) == 501, lambda: None)
    connector.PeriodicProcess()
    assert [content for _name, content in commands] == [
        f'{{"number": {number}}}' for number in range(500)
    ]
    assert order == [500]


def test_a_wrong_checksum_creates_the_node_but_does_not_fill_it(connector, simulator):
    damaged = bytearray(pack(Message("SimState", String("hello"))))
    damaged[-1] ^= 1
    simulator.send_bytes(bytes(damaged))
    wait_for(connector, lambda: incoming(connector, "SimState"))
    assert not incoming(connector, "SimState").GetText()


def test_a_command_expires_without_an_answer_and_is_not_sent_without_a_connection(scene):
    with SimulatorDouble(lambda *_: None) as simulator:
        connector = started_connector(scene, simulator)
        command = sent(connector, "Hello", timeout=0.05)
        wait_for(connector, lambda: command.GetCommandStatus() > command.CommandWaiting)
        assert command.GetCommandStatus() == command.CommandExpired
        connector.Stop()
        assert sent(connector, "Hello").GetCommandStatus() == command.CommandUnknown


def test_a_lost_connection_is_reported_only_after_the_next_one(scene):
    simulator = SimulatorDouble()
    connector = started_connector(scene, simulator)
    disconnections = count_events(connector, connector.DisconnectedEvent)
    wait_for(connector, lambda: not simulator.received.empty())
    # The nameless STATUS that Slicer opens each connection with.
    greeting = simulator.received.get_nowait()
    assert (greeting.device, greeting.content.code, greeting.timestamp) == ("", 0, 0.0)
    assert greeting.metadata == {"dummy": "dummy"}
    simulator.close()
    wait_for(connector, lambda: connector.GetState() == connector.StateWaitConnection)
    connector.PeriodicProcess()
    assert not disconnections
    with SimulatorDouble(port=simulator.port):
        wait_for(connector, lambda: disconnections)
        connector.Stop()


def test_any_call_that_would_crash_slicer_is_an_error_here(connector, simulator):
    data = bytearray(pack(Message("SimServer", Status(1))))
    data[2:14] = b"GET_STATUS\0\0"
    simulator.send_bytes(bytes(data))
    with pytest.raises(CrashError, match="GET_STATUS"):
        wait_for(connector, lambda: False)
    assert len(take_crashes()) == 1


@pytest.mark.parametrize(
    "said",
    [
        b"HTTP/1.1 400 Bad Request\r\nContent-Type: text/plain\r\nContent-Length: 0\r\n\r\n",
        pack(Message("SimServer", Status(1)))[:42] + struct.pack(">QQ", 2**31, 0),
    ],
    ids=["a web page", "a body of 2 GiB"],
)
def test_bytes_that_are_not_openigtlink_would_have_crashed_slicer(connector, simulator, said):
    simulator.send_bytes(said)
    crashes = []
    wait_for(connector, lambda: crashes.extend(take_crashes()) or crashes)
    assert len(crashes) == 1


def test_a_running_client_connects_to_its_new_port_after_a_loss(scene):
    with SimulatorDouble() as first, SimulatorDouble() as second:
        connector = started_connector(scene, first)
        connector.SetServerPort(second.port)
        wait_for(connector, lambda: not first.received.empty())
        assert second.peer_count == 0
        first.close()
        wait_for(connector, lambda: second.peer_count == 1)
        connector.Stop()
