"""Whatever is sent to the OpenIGTLink port ends at worst the connection on which it came."""

from __future__ import annotations

import pytest

from rastrainer.igtl.client import Client
from rastrainer.igtl.content import Transform
from rastrainer.igtl.message import Message
from Testing.benchmarks.bare_loop import BareLoop
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.security.attacked_process import (
    MOST_GROWTH_MB,
    MOST_MORE_DESCRIPTORS,
    cost_of,
    settled,
    told,
)
from Testing.security.link_attack import LinkAttack
from Testing.security.mutated_messages import MutatedMessages, valid_messages
from Testing.security.wire_police import SENT_TYPES

PROBE = Message("Probe", Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 4, 5, 6)))


def attack(folder, warm_up: int, count: int, policed: int, capsys) -> None:
    """Attack a simulator, and check that it is none the worse for it."""
    with (
        SimulatorProcess(folder, "--no-views", "--seed", "1") as simulator,
        Client(port=simulator.port) as good,
    ):
        good.wait_for("SimServer", timeout=20)
        LinkAttack(simulator.port, warm_up, seed=1, policed=policed).run()
        quiet = cost_of(simulator.pid, good)
        before = settled(simulator.pid, good, quiet)
        attacked = LinkAttack(simulator.port, count, seed=10**6, policed=policed)
        with BareLoop() as bare:
            attacked.run()
        after = settled(simulator.pid, good, before)
        with capsys.disabled():
            print(
                f"\n{attacked.sent} mutated messages on {attacked.connections} connections "
                f"({attacked.ended} ended early): "
                f"{told(before, after, bare)}"
            )
        assert after.descriptors <= before.descriptors + MOST_MORE_DESCRIPTORS
        assert after.resident_mb - before.resident_mb < MOST_GROWTH_MB
        good.send(PROBE)
        assert good.wait_for("Probe").content == PROBE.content
        assert good.send_command("ListTasks").ok
        assert attacked.sent >= count
        assert attacked.seen.keys() <= SENT_TYPES
        assert {b"RTS_COMMAND", b"TRANSFORM", b"STATUS"} <= attacked.seen.keys()
        status, errors = simulator.stop()
    assert status == 0
    assert "Traceback" not in errors
    assert " ERROR " not in errors


def test_five_thousand_mutated_messages_harm_nobody_else(tmp_path, capsys):
    attack(tmp_path / "records", 400, 5_000, 1, capsys)


@pytest.mark.soak
def test_a_million_mutated_messages_harm_nobody_else(tmp_path, capsys):
    attack(tmp_path / "records", 50_000, 1_000_000, 50, capsys)


def test_the_same_seed_gives_the_same_attack_and_every_valid_message_is_in_it():
    first, second = MutatedMessages(3), MutatedMessages(3)
    drawn = [first.next() for _ in range(3_000)]
    assert drawn == [second.next() for _ in range(3_000)]
    assert set(valid_messages()) <= set(drawn)
