"""A turn of the main loop processes a limited part of what a peer sends at once."""

import json

import pytest

from rastrainer.slicer.link.link import CHARACTERS_A_TURN, COMMANDS_A_TURN, MAX_KEPT
from rastrainer_headless.connector import HeadlessCommand


class Arrivals:
    """A link that the connector hands commands to; what it delivers is in `received`."""

    def __init__(self, link):
        self.link, self.received = link, []
        link.trialCompleted.connect(self.received.append)

    def keep(self, content, name="TrialCompleted"):
        command = HeadlessCommand()
        command.SetName(name)
        command.SetCommandContent(json.dumps(content))
        self.link._keepCommand(None, "", command)

    def counts(self, turns):
        """Yield how many commands each turn delivers."""
        for _ in range(turns):
            before = len(self.received)
            self.link.process()
            yield len(self.received) - before


@pytest.fixture
def arrivals(link):
    return Arrivals(link)


def test_commands_are_delivered_a_few_per_turn_in_order_and_unknown_ones_count_too(arrivals):
    for _ in range(COMMANDS_A_TURN):
        arrivals.keep({}, "Unknown")
    for number in range(2 * COMMANDS_A_TURN):
        arrivals.keep({"number": number})
    assert list(arrivals.counts(3)) == [0, COMMANDS_A_TURN, COMMANDS_A_TURN]
    assert [command["number"] for command in arrivals.received] == [*range(2 * COMMANDS_A_TURN)]


def test_fewer_long_commands_are_delivered_per_turn(arrivals):
    for _ in range(4):
        arrivals.keep({"text": CHARACTERS_A_TURN * "x"})
    assert list(arrivals.counts(5)) == [1, 1, 1, 1, 0]


def test_a_flood_keeps_no_more_than_the_queue_can_hold(arrivals):
    for number in range(10 * MAX_KEPT):
        arrivals.keep({"number": number})
    assert sum(arrivals.counts(10 * MAX_KEPT)) == MAX_KEPT
    assert [command["number"] for command in arrivals.received] == list(range(MAX_KEPT))
