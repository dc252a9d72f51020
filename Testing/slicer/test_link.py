"""The link survives what happens in a lab: restarts, cleared scenes, silence, other programs."""

import pytest

from rastrainer.errors import InputError
from rastrainer.igtl.content import Point, Points, Status
from rastrainer.igtl.message import Message, pack
from rastrainer.protocol import PROTOCOL_VERSION, DeviceName
from rastrainer.slicer.link.link import POSES_HZ
from rastrainer.slicer.link.link_status import RECONNECT_AFTER_S, LinkState
from rastrainer.slicer.scene.nodes import ROLE_ATTRIBUTE, Role
from Testing.slicer.simulator_double import SimulatorDouble, run_link_until


def beat(simulator):
    simulator.send_bytes(pack(simulator.heartbeat))


def connect(link, simulator):
    link.connectTo(port=simulator.port)
    run_link_until(link, lambda: simulator.commands)
    run_link_until(link, lambda: link.status.state is LinkState.CONNECTED)


def reply_to_list_tasks(link):
    replies = []
    link.send("ListTasks", onReply=replies.append, timeoutS=2.0)
    run_link_until(link, lambda: replies)
    return replies[0]


def hello(hz):
    wishes = {"protocolVersion": PROTOCOL_VERSION, "client": "3D Slicer"}
    return "Hello", {**wishes, "toolTipHz": hz, "linksHz": hz}


def test_hello_comes_first_and_is_repeated_to_request_poses_while_the_link_opens_once(
    link, simulator, clock
):
    clock.stop()
    opened, states = [], []
    link.opened.connect(lambda: opened.append(True))
    link.statusChanged.connect(lambda status: states.append(status.state))
    connect(link, simulator)
    for are_wanted in (True, True, False, False, True):
        link.requestPoses(are_wanted)
    run_link_until(link, lambda: len(simulator.commands) == 4)
    assert simulator.commands == [hello(0.0), hello(POSES_HZ), hello(0.0), hello(POSES_HZ)]
    assert reply_to_list_tasks(link).ok
    assert opened == [True]
    link.disconnect()
    assert states == [LinkState.LOOKING, LinkState.GREETING, LinkState.CONNECTED, LinkState.OFF]


def test_silence_is_reported_and_a_long_one_ends_the_half_open_connection(link, simulator, clock):
    clock.stop()
    connect(link, simulator)
    # One that is in transit may end the silence once.
    simulator.beats = False
    run_link_until(link, lambda: clock.skip_ahead() and link.status.state is LinkState.STALE)
    beat(simulator)
    run_link_until(link, lambda: link.status.state is LinkState.CONNECTED)
    connected = (LinkState.CONNECTED, LinkState.STALE)
    run_link_until(link, lambda: clock.skip_ahead() and link.status.state not in connected)
    run_link_until(link, lambda: len(simulator.commands) == 2)
    assert simulator.commands[1][0] == "Hello"


def test_a_connection_dead_before_the_first_heartbeat_is_reestablished(link, simulator, clock):
    clock.stop()
    simulator.beats = False
    link.connectTo(port=simulator.port)
    run_link_until(link, lambda: simulator.commands)
    run_link_until(link, lambda: clock.skip_ahead() and not link.seen.isOpen)
    run_link_until(link, lambda: len(simulator.commands) == 2)
    beat(simulator)
    run_link_until(link, lambda: link.status.state is LinkState.CONNECTED)


def test_a_slicer_that_was_itself_stalled_does_not_take_the_simulator_for_silent(
    link, simulator, clock
):
    clock.stop()
    connect(link, simulator)
    simulator.beats = False
    clock.ahead += 10 * RECONNECT_AFTER_S
    link.process()
    assert link.seen.isOpen
    assert link.status.state is LinkState.CONNECTED


def test_a_simulator_of_another_version_is_named_and_sent_no_commands(link, simulator):
    connect(link, simulator)
    # The link sees only the later of two heartbeats that come at once.
    other = Status(Status.OK, subcode=PROTOCOL_VERSION + 1)
    simulator.heartbeat = Message(DeviceName.SIM_SERVER, other)
    beat(simulator)
    run_link_until(link, lambda: link.status.state is LinkState.WRONG_VERSION)
    reply = reply_to_list_tasks(link)
    assert not reply.ok
    assert "version" in reply.error
    assert len(simulator.commands) == 1


def test_the_link_comes_back_when_the_simulator_does(link):
    with SimulatorDouble() as simulator:
        connect(link, simulator)
    run_link_until(link, lambda: link.status.state is LinkState.ABSENT)
    with SimulatorDouble(port=simulator.port) as restarted:
        run_link_until(link, lambda: restarted.commands)
        assert restarted.commands[0][0] == "Hello"


def test_touched_points_are_emitted_as_they_come_also_after_the_list_was_renamed_or_deleted(
    link, simulator, scene
):
    counts = []
    connect(link, simulator)
    link.pointsChanged.connect(lambda node: counts.append(node.GetNumberOfControlPoints()))
    for count in (1, 2, 1):
        points = tuple(Point(str(i + 1), (i, 0.0, 0.0)) for i in range(count))
        simulator.send(DeviceName.CAPTURED_POINTS, Points(points))
        run_link_until(link, lambda wanted=count: counts and counts[-1] == wanted)
        if len(counts) == 1:
            node = scene.GetFirstNode("CapturedPoints", "vtkMRMLMarkupsFiducialNode")
            assert node.GetAttribute(ROLE_ATTRIBUTE) == Role.CAPTURED_POINTS.role
            assert node.GetLocked()
            assert node.GetDisplayNode().GetGlyphScale() == 2.5
            node.SetName("mine")
    assert counts == [1, 2, 1]
    assert scene.GetFirstNodeByName("CapturedPoints") is None
    scene.RemoveNode(node)
    simulator.send(DeviceName.CAPTURED_POINTS, Points((Point("1", (0.0, 0.0, 0.0)),)))
    again = lambda: scene.GetFirstNodeByName("CapturedPoints")  # noqa: E731
    run_link_until(link, lambda: again() is not None and again().GetNumberOfControlPoints() == 1)


def test_without_a_connection_the_reply_says_so(link):
    replies = []
    link.send("ListTasks", onReply=replies.append)
    assert not replies
    link.process()
    assert replies[0].error == "Not connected."


@pytest.mark.parametrize(("host", "port", "words"), [("", 18944, "host"), ("a", 70000, "port")])
def test_an_invalid_address_is_refused_with_a_message(link, host, port, words):
    with pytest.raises(InputError, match=words):
        link.connectTo(host, port)
