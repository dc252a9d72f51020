"""Commands are answered at the connector's event, and a burst of them never blocks."""

import threading

import pytest

from rastrainer.slicer.link.link import MAX_AT_ONCE, Link
from rastrainer.slicer.link.link_status import LinkState
from rastrainer_headless.connector import headlessKit
from Testing.slicer.crashes import take_crashes
from Testing.slicer.simulator_double import SimulatorDouble, run_link_until, wait_until

BURST = 300


class Room:
    """A link to a simulator double, in a host whose next turn a test triggers."""

    def __init__(self, scene, clock, answer):
        self.clock = clock
        self.soon = []
        self.replies = []
        self.simulator = SimulatorDouble(answer)
        self.link = Link(scene, headlessKit, clock=self.clock, callSoon=self.soon.append)
        opened = []
        self.link.opened.connect(lambda: opened.append(True))
        self.link.connectTo(port=self.simulator.port)
        self.run_until(lambda: opened and self.link.status.state is LinkState.CONNECTED)
        self.soon.clear()

    def run_until(self, condition):
        run_link_until(self.link, condition)

    def wait_for_turn(self):
        """Let the connector work until it has asked for a turn; the link's own poll does not."""
        wait_until(lambda: self.soon, self.link.connector.PeriodicProcess)

    def ask(self, timeoutS=600.0):  # noqa: N803 (its name in Slicer)
        self.link.send("ListTasks", onReply=self.replies.append, timeoutS=timeoutS)

    def asked(self):
        return [name for name, _arguments in self.simulator.commands if name != "Hello"]

    def close(self):
        self.link.disconnect()
        self.simulator.close()


@pytest.fixture
def make_room(scene, clock):
    rooms = []

    def make(answer=lambda _name, _arguments: {}):
        rooms.append(Room(scene, clock, answer))
        return rooms[-1]

    yield make
    for room in rooms:
        room.close()


@pytest.fixture
def silent(make_room):
    """A simulator that answers only once `silent.may_answer` is set."""
    may_answer = threading.Event()

    def answer(name, _arguments):
        assert name == "Hello" or may_answer.wait(60)
        return {}

    room = make_room(answer)
    room.may_answer = may_answer
    yield room
    may_answer.set()


def test_answers_and_trials_are_delivered_in_the_next_turn_without_waiting_for_the_poll(make_room):
    room, records = make_room(), []
    room.ask()
    room.wait_for_turn()
    assert room.replies == []  # Inside VTK nothing is handed over.
    room.soon.pop()()
    assert [reply.ok for reply in room.replies] == [True]
    room.link.trialCompleted.connect(records.append)
    room.simulator.send_command("TrialCompleted", {"number": 1})
    room.wait_for_turn()
    assert records == []
    room.soon.pop()()
    assert records == [{"number": 1}]


def test_only_one_turn_is_requested_however_much_arrives(make_room):
    room = make_room()
    room.link.process()
    room.clock.stop()
    for _ in range(5):
        room.ask()
        room.simulator.send_command("Unknown", {})
    wait_until(lambda: len(room.asked()) == 5, lambda: None)
    room.wait_for_turn()
    for _ in range(100):
        room.link.connector.PeriodicProcess()
    assert len(room.soon) == 1


def test_a_turn_after_the_link_was_closed_does_nothing(make_room):
    room = make_room()
    room.ask()
    room.wait_for_turn()
    room.link.disconnect()
    room.soon.pop()()
    assert len(room.replies) == 1


def test_a_burst_is_sent_a_few_at_a_time_and_fully_answered_in_order(make_room):
    room, numbers = make_room(lambda _name, arguments: {"number": arguments.get("folder")}), []
    for number in range(BURST):
        room.link.send(
            "LoadScenario",
            {"folder": str(number)},
            lambda reply: numbers.append(reply.data["number"]),
        )
    room.run_until(lambda: len(numbers) == BURST)
    assert numbers == [str(number) for number in range(BURST)]


def test_nothing_more_is_sent_to_a_simulator_that_does_not_answer(silent):
    for _ in range(BURST):
        silent.ask()
    for _ in range(50):
        silent.link.process()
    wait_until(lambda: silent.asked(), lambda: None)
    assert silent.link.connector._nextCommandId - 2 == MAX_AT_ONCE
    silent.may_answer.set()
    silent.run_until(lambda: len(silent.replies) == BURST)
    assert all(reply.ok for reply in silent.replies)


def test_commands_still_waiting_when_the_connection_is_lost_are_refused(silent):
    silent.clock.stop()
    for _ in range(BURST):
        silent.ask()
    silent.simulator.close()
    silent.run_until(lambda: len(silent.replies) == BURST)
    assert {reply.error for reply in silent.replies} == {
        "The connection to the simulator was lost."
    }


def test_an_abandoned_command_lives_until_the_connector_is_done_with_it(silent):
    silent.ask(timeoutS=2.0)
    wait_until(lambda: silent.asked(), lambda: None)
    silent.clock.ahead += 3.0
    silent.link.process()
    assert "did not answer" in silent.replies[0].error
    silent.may_answer.set()
    silent.ask()
    silent.run_until(lambda: len(silent.replies) == 2)
    assert silent.replies[1].ok


def test_the_stand_in_reports_a_command_that_died_too_early(silent):
    command = headlessKit().makeCommand()
    command.SetName("ListTasks")
    silent.link.connector.SendCommand(command)
    del command
    silent.may_answer.set()
    with pytest.raises(RuntimeError, match="deleted before"):
        wait_until(lambda: False, silent.link.connector.PeriodicProcess)
    assert take_crashes()


def test_in_the_module_an_answer_needs_no_poll(host, module_widget, simulator):
    link, replies = module_widget.logic.session.link, []
    link.connectTo(port=simulator.port)
    host.wait_until(lambda: link.status.state is LinkState.CONNECTED, "it connects")
    module_widget._timer.stop()
    link.send("ListTasks", onReply=replies.append)
    host.wait_until(lambda: replies, "the answer is handed over")
    assert replies[0].ok
