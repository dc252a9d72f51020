"""A turn of the main loop processes a limited part of what a peer sends at once."""

import json

import pytest

from rastrainer.slicer.link.pending_commands import (
    CHARACTERS_A_TURN,
    COMMANDS_A_TURN,
    MAX_KEPT,
    Arrivals,
)
from rastrainer.slicer.signal import ErrorGuard, Signal


@pytest.fixture
def received():
    return []


@pytest.fixture
def arrivals(scene, received):
    known = Signal()
    known.connect(received.append)
    return Arrivals(scene, ErrorGuard(), Signal(), Signal(), {"Known": known})


def test_commands_are_delivered_a_few_per_turn_in_order(arrivals, received):
    for number in range(3 * COMMANDS_A_TURN):
        arrivals.keepCommand("Known", json.dumps({"number": number}))
    for turn in range(1, 4):
        arrivals.emitCommands()
        assert len(received) == turn * COMMANDS_A_TURN
    assert [command["number"] for command in received] == list(range(3 * COMMANDS_A_TURN))


def test_fewer_long_commands_are_delivered_per_turn(arrivals, received):
    for _ in range(4):
        arrivals.keepCommand("Known", json.dumps({"text": CHARACTERS_A_TURN * "x"}))
    for turn in range(1, 5):
        arrivals.emitCommands()
        assert len(received) == turn


def test_a_flood_keeps_no_more_than_the_queue_can_hold(arrivals, received):
    for number in range(10 * MAX_KEPT):
        arrivals.keepCommand("Known", json.dumps({"number": number}))
    for _ in range(10 * MAX_KEPT):
        arrivals.emitCommands()
    assert [command["number"] for command in received] == list(range(MAX_KEPT))


def test_unknown_commands_count_as_well(arrivals, received):
    for _ in range(COMMANDS_A_TURN):
        arrivals.keepCommand("Unknown", "{}")
    arrivals.keepCommand("Known", "{}")
    arrivals.emitCommands()
    assert received == []
    arrivals.emitCommands()
    assert received == [{}]
