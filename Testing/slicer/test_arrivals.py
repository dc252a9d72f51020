"""A turn of the main loop processes a limited part of what a peer sends at once."""

import json

from rastrainer.slicer.link.link import CHARACTERS_A_TURN, COMMANDS_A_TURN, MAX_KEPT
from rastrainer_headless.connector import HeadlessCommand


def keep(link, content, name="TrialCompleted"):
    """Have the connector hand a command to the link."""
    command = HeadlessCommand()
    command.SetName(name)
    command.SetCommandContent(json.dumps(content))
    link._keepCommand(None, "", command)


def counts(link, received, turns):
    """Yield how many commands each turn delivers."""
    for _ in range(turns):
        before = len(received)
        link.process()
        yield len(received) - before


def test_a_flood_is_delivered_a_little_per_turn_in_order_and_only_as_much_as_is_kept(link):
    received = []
    link.trialCompleted.connect(received.append)
    for _ in range(COMMANDS_A_TURN):
        keep(link, {}, "Unknown")
    for number in range(10 * MAX_KEPT):
        keep(link, {"number": number})
    assert list(counts(link, received, 3)) == [0, COMMANDS_A_TURN, COMMANDS_A_TURN]
    assert sum(counts(link, received, MAX_KEPT)) + 2 * COMMANDS_A_TURN == len(received)
    assert [command["number"] for command in received] == [*range(MAX_KEPT - COMMANDS_A_TURN)]
    for _ in range(4):
        keep(link, {"text": CHARACTERS_A_TURN * "x"})
    assert list(counts(link, received, 5)) == [1, 1, 1, 1, 0]
