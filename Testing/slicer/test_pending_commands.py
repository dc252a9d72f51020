"""Commands are answered at the connector's event, and a burst of them never blocks."""

import threading

import pytest

from rastrainer.slicer.link.link import MAX_AT_ONCE, Link
from rastrainer.slicer.link.link_status import LinkState
from rastrainer_headless.connector import headlessKit
from Testing.slicer.simulator_double import SimulatorDouble, run_link_until, wait_until

BURST = 300


class Room:
    """A link to a simulator double that answers while it may, in a host driven by the test."""

    def __init__(self, scene, clock):
        self.soon, self.replies = [], []
        self.may_answer = threading.Event()
        self.may_answer.set()
        self.simulator = SimulatorDouble(self.answer)
        self.link = Link(scene, headlessKit, clock=clock, callSoon=self.soon.append)
        opened = []
        self.link.opened.connect(lambda: opened.append(True))
        self.link.connectTo(port=self.simulator.port)
        self.run_until(lambda: opened and self.link.status.state is LinkState.CONNECTED)
        self.soon.clear()

    def answer(self, name, arguments):
        assert name == "Hello" or self.may_answer.wait(60)
        return {"number": arguments.get("folder")}

    def run_until(self, condition):
        run_link_until(self.link, condition)

    def take_turn(self):
        """Let the connector work until it has asked for a turn; the link's own poll does not."""
        wait_until(lambda: self.soon, self.link.connector.PeriodicProcess)
        assert len(self.soon) == 1
        self.soon.pop()()

    def ask(self, number=0, timeoutS=600.0):  # noqa: N803 (its name in Slicer)
        self.link.send("LoadScenario", {"folder": str(number)}, self.replies.append, timeoutS)

    def wait_until_asked(self):
        wait_until(lambda: self.simulator.commands[-1][0] != "Hello", lambda: None)


@pytest.fixture
def room(scene, clock):
    room = Room(scene, clock)
    yield room
    room.may_answer.set()
    room.link.disconnect()
    room.simulator.close()


def test_answers_and_trials_are_delivered_in_the_next_turn_without_waiting_for_the_poll(room):
    records = []
    room.ask()
    wait_until(lambda: room.soon, room.link.connector.PeriodicProcess)
    assert room.replies == []  # Inside VTK nothing is handed over.
    room.take_turn()
    assert [reply.ok for reply in room.replies] == [True]
    room.link.trialCompleted.connect(records.append)
    room.simulator.send_command("TrialCompleted", {"number": 1})
    room.take_turn()
    assert records == [{"number": 1}]


def test_a_burst_is_sent_a_few_at_a_time_and_fully_answered_in_order(room):
    for number in range(BURST):
        room.ask(number)
    room.run_until(lambda: len(room.replies) == BURST)
    assert [reply.data["number"] for reply in room.replies] == [*map(str, range(BURST))]


def test_a_simulator_that_does_not_answer_is_sent_no_more_and_what_waits_is_refused_at_its_end(
    room, clock
):
    clock.stop()
    room.may_answer.clear()
    for _ in range(BURST):
        room.ask()
    for _ in range(50):
        room.link.process()
    room.wait_until_asked()
    assert room.link.connector._nextCommandId - 2 == MAX_AT_ONCE
    room.simulator.close()
    room.run_until(lambda: len(room.replies) == BURST)
    assert {reply.error for reply in room.replies} == {"The connection to the simulator was lost."}


def test_an_abandoned_command_lives_until_the_connector_is_done_with_it(room, clock):
    room.may_answer.clear()
    room.ask(timeoutS=2.0)
    room.wait_until_asked()
    clock.ahead += 3.0
    room.link.process()
    assert "did not answer" in room.replies[0].error
    room.may_answer.set()
    room.ask()
    room.run_until(lambda: len(room.replies) == 2)
    assert room.replies[1].ok


def test_in_the_module_an_answer_needs_no_poll(host, module_widget, simulator):
    link, replies = module_widget.logic.session.link, []
    link.connectTo(port=simulator.port)
    host.wait_until(lambda: link.status.state is LinkState.CONNECTED, "it connects")
    module_widget._timer.stop()
    link.send("ListTasks", onReply=replies.append)
    host.wait_until(lambda: replies, "the answer is handed over")
    assert replies[0].ok
