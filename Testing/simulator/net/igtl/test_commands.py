"""Commands over real sockets: each is answered once, with what would have been right."""

import json
from concurrent.futures import Future

import pytest

from rastrainer import commands
from rastrainer.igtl.client import Client
from rastrainer.igtl.content import Command
from rastrainer.igtl.message import Message, pack
from rastrainer.protocol import PROTOCOL_VERSION
from rastrainer_simulator.state import Answer
from rastrainer_simulator.texts.texts import LANGUAGES, Texts
from Testing.security.mutated_messages import COMMANDS
from Testing.simulator.net.igtl.servers import LinkServer, answer_to

HELLO = {"protocolVersion": PROTOCOL_VERSION, "client": "test"}
OF_SCORING_CLIENTS = {
    *("UseRegistration", "SubmitRegistration", "TrialScored", "GetJournal", "AcknowledgeTrial")
}


def test_a_client_that_does_not_score_neither_registers_nor_scores_nor_acknowledges(
    client, link_server
):
    for hello in ({}, {**HELLO, "scores": False}):
        if hello:
            client.send_command("Hello", hello)
        for name in OF_SCORING_CLIENTS:
            reply = client.send_command(name, COMMANDS[name])
            assert "is for clients that register and score" in reply.error
    assert link_server.simulated.commands == []


def test_every_command_of_the_protocol_is_answered(client):
    for name in commands.COMMANDS.keys() - OF_SCORING_CLIENTS:
        assert client.send_command(name, COMMANDS[name]).ok, name


def test_simulation_gets_checked_arguments_and_the_name_of_the_client(client, link_server):
    client.send_command("Hello", HELLO)
    client.send_command("Jog", {"velocityMmS": [1, 2, 3]})
    name, arguments, sender = link_server.simulated.commands[-1]
    assert (name, sender) == ("Jog", "test")
    assert arguments == {"velocityMmS": (1.0, 2.0, 3.0), "frame": "world", "durationS": 0.1}


def test_refusal_by_the_rules_of_a_trial_has_its_code_its_values_and_an_english_sentence(
    client, link_server
):
    said = Texts(LANGUAGES["de"]).say("tutorial is open", trainee="anna")
    link_server.simulated.answer = lambda *_: Answer(0, False, said)
    reply = client.send_command("StartTutorial", COMMANDS["StartTutorial"])
    assert reply.error.startswith("anna is doing the tutorial: let them finish it")
    assert reply.data == {
        "error": reply.error,
        "code": "tutorial is open",
        "values": {"trainee": "anna"},
    }


@pytest.mark.parametrize(
    ("name", "arguments", "words"),
    [
        ("Fly", {}, 'The command "Fly" is unknown; known are Hello, ListTasks'),
        ("Trace", {"on": True, "of": 3}, 'Trace: there is no "of"; use on.'),
        ("StartTask", {"task": "task-1"}, 'StartTask needs the key "trainee"'),
        ("Jog", {"velocityMmS": [1, 2, 1e9]}, "must be a list of 3 numbers within ±500 mm/s"),
        ("GetTrial", {"trialId": "../../etc/passwd"}, "must be the UUID of a trial"),
    ],
)
def test_wrong_command_is_answered_with_what_would_be_right(client, name, arguments, words):
    reply = client.send_command(name, arguments)
    assert not reply.ok
    assert words in reply.error
    assert reply.data["error"] == reply.error


def test_body_that_is_not_a_json_object_is_refused(link_server):
    many = json.dumps({str(number): number for number in range(1001)})
    for body in ("[]", "nonsense", '{"velocityMmS": NaN}', "[" * 60_000, '{"x": 1e999}', many):
        command = pack(Message("command", Command(77, "Jog", body)))
        reply = answer_to(link_server.port, command)
        assert reply.metadata["Status"] == "FAIL"
        assert "must be one JSON object with finite numbers" in reply.metadata["ErrorMessage"]


def test_hello_of_another_protocol_version_is_refused_with_ours(client):
    reply = client.send_command("Hello", {**HELLO, "protocolVersion": PROTOCOL_VERSION + 1})
    assert "install RASTrainer of the same version on both sides" in reply.error
    assert reply.data["protocolVersion"] == PROTOCOL_VERSION


def test_only_a_client_that_declares_it_counts_as_slicer(client, link_server):
    def is_slicer_connected(**hello):
        client.send_command("Hello", {**HELLO, **hello})
        return link_server.link.is_slicer_connected

    assert not link_server.link.is_slicer_connected
    assert not is_slicer_connected(protocolVersion=PROTOCOL_VERSION + 1)
    assert is_slicer_connected()
    assert not is_slicer_connected(scores=False)
    assert is_slicer_connected(scores=True)


def test_simulation_is_given_only_a_few_commands_of_one_client_at_once(start):
    server = start(LinkServer, commands_at_once=4)
    given = []

    def hold(*_):
        given.append(Future())
        return given[-1]

    server.link._submit_command = hold
    with Client(port=server.port) as client:
        for number in range(1000, 1020):
            client.send(Message("command", Command(number, "Capture")))
        client.send_command("Fly")
        assert len(given) == 4
        for _ in range(20):
            given.pop(0).set_result(Answer(0, True))
            client.send_command("Fly")
        assert given == []


def test_client_with_too_many_commands_is_refused(start):
    server = start(LinkServer, commands_at_once=1, waiting_commands=2)
    server.link._submit_command = lambda *_: Future()
    with Client(port=server.port) as client:
        for number in range(1000, 1003):
            client.send(Message("command", Command(number, "Capture")))
        assert "Too many commands wait" in client.send_command("Capture").error


def test_commands_of_clients_that_have_left_are_limited_too(start):
    server, held = start(LinkServer, commands_of_all=3), []

    def hold(*_):
        held.append(Future())
        return held[-1]

    server.link._submit_command = hold
    for number in range(4):
        with Client(port=server.port) as client:
            client.send(Message("command", Command(number, "Capture")))
            client.send_command("Fly")
    assert len(held) == 3
    with Client(port=server.port) as client:
        assert "Too many commands wait" in client.send_command("Capture").error
        for future in held[:3]:
            future.set_result(Answer(0, True))
        client.send(Message("command", Command(4, "Capture")))
        client.send_command("Fly")
        assert len(held) == 4


def test_simulation_that_fails_is_reported_and_the_link_continues(client, link_server):
    def fail(*_):
        future = Future()
        future.set_exception(RuntimeError("broken"))
        return future

    link_server.link._submit_command = fail
    assert "could not carry the command out" in client.send_command("Capture").error
    assert client.send_command("Hello", HELLO).ok
