"""No client takes more than its share of the processor, and none loses anything by waiting."""

from __future__ import annotations

import pytest

from rastrainer.igtl.client import Client
from rastrainer.igtl.content import String
from rastrainer.igtl.message import Message
from rastrainer_simulator.loop.rates import ReadingBudget
from Testing.simulator.net.igtl.servers import PlainServer


def test_new_client_waits_for_what_its_first_bytes_have_cost():
    assert ReadingBudget(now=0.0).charge(0.003, share=0.1, now=0.0) == pytest.approx(0.03)


def test_client_below_its_share_never_waits():
    budget = ReadingBudget(now=0.0)
    assert all(budget.charge(0.001, 0.1, now=0.02 * i) == 0 for i in range(1, 500))


def test_client_above_its_share_gets_its_share_and_no_more():
    budget, now, read = ReadingBudget(now=0.0), 0.0, 0.0
    while now < 10.0:
        read += 0.002
        now += 0.002
        now += budget.charge(0.002, 0.1, now)
    assert read == pytest.approx(1.0, rel=0.02)


def test_long_silence_saves_up_little():
    budget = ReadingBudget(now=0.0)
    assert budget.charge(0.05, 0.1, now=3600.0) == pytest.approx(0.3)


def test_flood_is_read_slowly_but_wholly_and_in_order(start):
    server = start(PlainServer, reading_share=0.05)
    with Client(port=server.port) as flood, Client(port=server.port) as other:
        for number in range(300):
            flood.send(Message("Flood", String(str(number))))
        other.send(Message("Other", String("")))
        server.handler.wait_for_messages(301)
    texts = [m.content.text for m in server.handler.messages if m.device == "Flood"]
    assert texts == [str(number) for number in range(300)]
