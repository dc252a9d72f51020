"""A turn of the main loop processes a limited part of what a peer sends at once."""

import json

import pytest

from rastrainer.slicer.link.connection import MAX_KEPT
from rastrainer.slicer.link.link import CHARACTERS_A_TURN, COMMANDS_A_TURN
from rastrainer_headless.command import HeadlessCommand


@pytest.fixture
def received():
    return []


class Arrivals:
    """A link that the connector hands commands to."""

    def __init__(self, link):
        self.link = link

    def keep(self, name, content):
        command = HeadlessCommand()
        command.SetName(name)
        command.SetCommandContent(content)
        self.link._keepCommand(None, "", command)


@pytest.fixture
def arrivals(link, received):
    link.trialCompleted.connect(received.append)
    return Arrivals(link)


def test_commands_are_delivered_a_few_per_turn_in_order(arrivals, received):
    for number in range(3 * COMMANDS_A_TURN):
        arrivals.keep("TrialCompleted", json.dumps({"number": number}))
    for turn in range(1, 4):
        arrivals.link.process()
        assert len(received) == turn * COMMANDS_A_TURN
    assert [command["number"] for command in received] == list(range(3 * COMMANDS_A_TURN))


def test_fewer_long_commands_are_delivered_per_turn(arrivals, received):
    for _ in range(4):
        arrivals.keep("TrialCompleted", json.dumps({"text": CHARACTERS_A_TURN * "x"}))
    for turn in range(1, 5):
        arrivals.link.process()
        assert len(received) == turn


def test_a_flood_keeps_no_more_than_the_queue_can_hold(arrivals, received):
    for number in range(10 * MAX_KEPT):
        arrivals.keep("TrialCompleted", json.dumps({"number": number}))
    for _ in range(10 * MAX_KEPT):
        arrivals.link.process()
    assert [command["number"] for command in received] == list(range(MAX_KEPT))


def test_unknown_commands_count_as_well(arrivals, received):
    for _ in range(COMMANDS_A_TURN):
        arrivals.keep("Unknown", "{}")
    arrivals.keep("TrialCompleted", "{}")
    arrivals.link.process()
    assert received == []
    arrivals.link.process()
    assert received == [{}]
