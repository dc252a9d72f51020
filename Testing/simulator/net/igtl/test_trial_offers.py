"""A finished trial is offered again and again until a client acknowledges it."""

import json
from dataclasses import dataclass

import pytest

from rastrainer.igtl.client import Client
from rastrainer.json_records import record_from_json
from rastrainer.protocol import PROTOCOL_VERSION, Phase
from rastrainer.trial.record import AbortedTrial
from rastrainer_simulator.net.igtl.simulator_link import OFFERS_AT_ONCE
from rastrainer_simulator.state import TrainingState
from Testing.domain.trial.trial_records import make_aborted
from Testing.simulator.net.igtl.servers import LinkServer, at_rest


@dataclass
class Offered:
    """All that is read of a record to offer it."""

    trial_id: str


class Collector(Client):
    """A client that keeps the offers it gets."""

    def __init__(self, server: LinkServer, *names: str):
        self.offers = []
        self.names = names or ("TrialCompleted",)
        self.server = server
        super().__init__(port=server.port, on_message=self._keep)
        self._send_hello()

    def _keep(self, message):
        if message.device == "command":
            assert message.content.name in self.names
            self.offers.append(message.content)

    def _send_hello(self):
        """Wait for an answer: all earlier messages have then arrived."""
        self.send_command("Hello", {"protocolVersion": PROTOCOL_VERSION, "client": "collector"})

    def after(self, action) -> list[str]:
        """Return the trials that were offered up to now, once `action` has been carried out."""
        self.server.thread.call(action)
        self._send_hello()
        offered = [json.loads(offer.body)["trialId"] for offer in self.offers]
        self.offers.clear()
        return offered


@pytest.fixture
def collector(link_server):
    with Collector(link_server) as collector:
        yield collector


def test_trial_is_offered_the_moment_it_is_registered(collector, link_server):
    link_server.simulated.unacknowledged = (Offered("old"), Offered("new"))
    link_server.simulated.arrivals = 1
    registered = at_rest(training=TrainingState(1, Phase.REGISTERED, trial_id="new"))
    assert collector.after(lambda: link_server.link.publish(registered)) == ["new"]
    assert collector.after(lambda: link_server.link.publish(registered)) == []


def test_aborted_trials_are_offered_before_one_finished_later(link_server):
    """A client that has just connected would otherwise count a repeat before it knows of both."""
    aborted = record_from_json(AbortedTrial, make_aborted())
    link_server.simulated.unacknowledged = (aborted, Offered("old"), Offered("repeat"))
    link_server.simulated.arrivals = 1
    registered = at_rest(training=TrainingState(1, Phase.REGISTERED, trial_id="repeat"))
    with Collector(link_server, "TrialAborted", "TrialCompleted") as collector:
        offered = collector.after(lambda: link_server.link.publish(registered))
    assert offered == [aborted.trial_id, "repeat"]


def test_trial_is_offered_again_until_it_is_acknowledged(collector, link_server):
    link_server.simulated.unacknowledged = (Offered("a"), Offered("b"))
    assert collector.after(link_server.link.offers.repeat) == ["a", "b"]
    assert collector.after(link_server.link.offers.repeat) == ["a", "b"]
    link_server.simulated.unacknowledged = (Offered("b"),)
    assert collector.after(link_server.link.offers.repeat) == ["b"]
    link_server.simulated.unacknowledged = ()
    assert collector.after(link_server.link.offers.repeat) == []


def test_trials_that_nobody_acknowledges_do_not_hold_up_the_others(collector, link_server):
    names = [str(i) for i in range(OFFERS_AT_ONCE * 2 + 3)]
    link_server.simulated.unacknowledged = tuple(Offered(name) for name in names)
    offered = [collector.after(link_server.link.offers.repeat) for _ in range(3)]
    assert {name for names in offered for name in names} == set(names)
    assert max(map(len, offered)) == OFFERS_AT_ONCE
