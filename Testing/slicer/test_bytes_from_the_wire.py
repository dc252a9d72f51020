"""Texts that are not UTF-8 arrive as bytes, and what fails blocks nothing else."""

import struct

import pytest

from rastrainer.files.point_list import PointList
from rastrainer.igtl.content import Command, CommandReply, Point, Points, String
from rastrainer.igtl.message import HEADER_BYTES, Message, crc64, pack
from rastrainer.protocol import DeviceName
from rastrainer.slicer.link.link import Link
from rastrainer.slicer.link.link_status import LinkState
from rastrainer.slicer.scene.nodes import labelsOf
from rastrainer_headless.connector import headlessKit
from Testing.slicer.simulator_double import run_link_until

LATIN_1 = "Gehäuse".encode("latin-1")


@pytest.fixture
def link(scene, simulator):
    link = Link(scene, headlessKit)
    link.connectTo(port=simulator.port)
    run_link_until(link, lambda: link.status.state is LinkState.CONNECTED)
    yield link
    link.disconnect()


def with_latin_1(message, placeholder=b"Geh?use"):
    """Return a message's bytes with one text in Latin 1 in place of the placeholder's."""
    data = pack(message)
    assert placeholder in data
    body = data[HEADER_BYTES:].replace(placeholder, LATIN_1)
    return data[: HEADER_BYTES - 8] + struct.pack(">Q", crc64(body)) + body


POINTS = Points((Point("Geh?use", (1.0, 2.0, 3.0)), Point("2", (4.0, 5.0, 6.0))))


def test_a_state_that_is_not_utf_8_is_refused_with_a_message_and_the_next_one_is_read(
    link, simulator, caplog
):
    states = []
    link.stateChanged.connect(states.append)
    simulator.send_bytes(
        with_latin_1(Message(DeviceName.SIM_STATE, String('{"phase": "Geh?use"}')))
    )
    run_link_until(link, lambda: "cannot be read" in caplog.text)
    assert "UTF-8" in caplog.text
    simulator.send(DeviceName.SIM_STATE, String('{"phase": "idle"}'))
    run_link_until(link, lambda: states)
    assert states == [{"phase": "idle"}]


def test_a_label_that_is_not_utf_8_is_shown_with_a_replacement_and_its_point_registered(
    link, simulator, scene
):
    lists = []
    link.pointsChanged.connect(lambda node: lists.append(labelsOf(node)))
    simulator.send_bytes(with_latin_1(Message(DeviceName.CAPTURED_POINTS, POINTS)))
    run_link_until(link, lambda: lists)
    assert lists == [("Geh\ufffduse", "2")]
    node = scene.GetFirstNodeByName(DeviceName.CAPTURED_POINTS)
    assert node.GetNthControlPointLabel(0) == LATIN_1
    assert PointList(labelsOf(node), [(1, 2, 3), (4, 5, 6)]).labels == lists[0]


@pytest.mark.parametrize(
    "command",
    [Command(7, "Geh?use", "{}"), Command(7, "TrialCompleted", '{"trainee": "Geh?use"}')],
)
def test_a_command_that_is_not_utf_8_is_logged_and_the_next_one_is_read(
    link, simulator, caplog, command
):
    records = []
    link.trialCompleted.connect(records.append)
    simulator.send_bytes(with_latin_1(Message(DeviceName.COMMAND, command)))
    simulator.send_command("TrialCompleted", {"number": 8})
    run_link_until(link, lambda: records)
    assert records == [{"number": 8}]
    assert "cannot be read" in caplog.text or "unknown command Geh\ufffduse" in caplog.text


@pytest.mark.parametrize(
    ("status", "body", "error"),
    [
        ("SUCCESS", '{"title": "Geh?use"}', "The simulator's answer cannot be read."),
        ("FAIL", "{}", "No Geh\ufffduse."),
    ],
)
def test_an_answer_that_is_not_utf_8_becomes_a_reply_with_an_error_message(
    link, simulator, monkeypatch, status, body, error
):
    def answer(_peer, command):
        reply = CommandReply(command.command_id, command.name, body)
        metadata = {"Status": status, "ErrorMessage": "No Geh?use."}
        simulator.send_bytes(with_latin_1(Message(DeviceName.COMMAND, reply, metadata)))

    monkeypatch.setattr(simulator, "_answer", answer)
    replies = []
    link.send("ListTasks", onReply=replies.append)
    run_link_until(link, lambda: replies)
    assert (replies[0].ok, replies[0].error) == (False, error)


def test_a_failing_listener_does_not_stop_the_others(link, simulator, contained_failures):
    def fail(_value):
        raise KeyError("a listener's mistake")

    received = []
    for signal in (link.stateChanged, link.pointsChanged, link.trialCompleted):
        signal.connect(fail)
        signal.connect(received.append)
    for number in range(3):
        simulator.send_command("TrialCompleted", {"number": number})
    simulator.send(DeviceName.CAPTURED_POINTS, POINTS)
    simulator.send(DeviceName.SIM_STATE, String("{}"))
    link.send("ListTasks", onReply=lambda _reply: fail(0))
    link.send("ListTasks", onReply=received.append)
    run_link_until(link, lambda: len(received) == 6)
    # Each different failure is logged once.
    assert len(contained_failures) == 4
    assert "a listener's mistake" in contained_failures[0]
    contained_failures.clear()
