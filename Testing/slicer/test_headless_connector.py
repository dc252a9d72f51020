"""The stand-in of the connector behaves as `vtkMRMLIGTLConnectorNode` was measured to behave."""

import struct

import pytest
import vtk

from rastrainer.igtl.content import Status, String
from rastrainer.igtl.message import Message, pack
from rastrainer_headless.connector import CrashError, HeadlessCommand, HeadlessConnector, crashes
from Testing.slicer.simulator_double import wait_until


def take_crashes():
    """Return the crashes recorded since the last call."""
    taken = crashes[:]
    crashes.clear()
    return taken


@pytest.fixture
def connector(scene, simulator):
    connector = HeadlessConnector()
    scene.AddNode(connector)
    connector.SetTypeClient("127.0.0.1", simulator.port)
    assert connector.Start() == 1
    wait_until(lambda: connector.GetState() == connector.StateConnected, lambda: None)
    wait_until(lambda: simulator.peer_count == 1, lambda: None)
    yield connector
    connector.Stop()


def wait_for(connector, condition):
    wait_until(condition, connector.PeriodicProcess)


def test_in_a_burst_no_command_is_lost_and_the_latest_of_each_other_device_comes_after_them(
    connector, simulator, scene
):
    commands, order = [], []

    def keep(_caller, _event, command):
        commands.append(command.GetCommandContent())

    keep.CallDataType = vtk.VTK_OBJECT
    connector.AddObserver(connector.CommandReceivedEvent, keep)
    scene.AddObserver(scene.NodeAddedEvent, lambda *_: order.append(len(commands)))
    for number in range(100):
        simulator.send("SimState", String(str(number)))
        simulator.send_command("TrialCompleted", {"number": number})
    wait_until(lambda: len(connector._commands) + len(connector._latest) == 101, lambda: None)
    connector.PeriodicProcess()
    assert commands == [f'{{"number": {number}}}' for number in range(100)]
    assert order == [100]
    assert scene.GetFirstNodeByName("SimState").GetText() == "99"


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
    wait_for(connector, take_crashes)


def test_a_call_or_a_command_deleted_too_early_that_would_crash_slicer_is_an_error_here(
    connector, simulator
):
    command = HeadlessCommand()
    command.SetName("ListTasks")
    command.SetCommandContent("{}")
    connector.SendCommand(command)
    del command
    with pytest.raises(RuntimeError, match="deleted before"):
        wait_for(connector, lambda: False)
    data = bytearray(pack(Message("SimServer", Status(1))))
    data[2:14] = b"GET_STATUS\0\0"
    simulator.send_bytes(bytes(data))
    with pytest.raises(CrashError, match="GET_STATUS"):
        wait_for(connector, lambda: False)
    assert len(take_crashes()) == 2
