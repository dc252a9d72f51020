"""Any bytes sent to the OpenIGTLink port end at worst their own connection."""

import pytest

from rastrainer import commands
from rastrainer.commands import check_arguments
from rastrainer.igtl.client import Client
from rastrainer.igtl.content import Transform
from rastrainer.igtl.message import Message
from Testing.end_to_end.simulator_process import SimulatorProcess
from Testing.security.attacked_process import cost_of, counted_in_log, is_unharmed, settled
from Testing.security.link_attack import LinkAttack
from Testing.security.mutated_messages import COMMANDS
from Testing.security.wire_checker import SENT_TYPES

MAX_READ = 0.75
"""Share of the messages that the server must have decoded or refused one by one."""
PROBE = Message("Probe", Transform((1, 0, 0, 0, 1, 0, 0, 0, 1, 4, 5, 6)))


def attack(folder, warm_up: int, count: int, policed: int) -> None:
    """Attack a simulator, and check that it is unharmed."""
    with (
        SimulatorProcess(folder, "--no-views", "--seed", "1") as simulator,
        Client(port=simulator.port) as good,
    ):
        good.wait_for("SimServer", timeout=60)
        warming = LinkAttack(simulator.port, warm_up, seed=1, policed=policed)
        warming.run()
        quiet = cost_of(simulator.pid, good)
        before = settled(simulator.pid, good, quiet)
        attacked = LinkAttack(simulator.port, count, seed=10**6, policed=policed)
        attacked.run()
        after = settled(simulator.pid, good, before)
        assert is_unharmed(before, after), (before, after)
        good.send(PROBE)
        assert good.wait_for("Probe").content == PROBE.content
        assert good.send_command("ListTasks").ok
        assert attacked.mutated >= count
        # The rest are pieces of others, such as what follows a message that was cut.
        assert attacked.decoded + attacked.refused.total() >= MAX_READ * attacked.sent
        assert attacked.seen.keys() <= SENT_TYPES
        assert {b"RTS_COMMAND", b"TRANSFORM", b"STATUS"} <= attacked.seen.keys()
        status, errors = simulator.stop()
    assert status == 0
    assert "Traceback" not in errors
    assert " ERROR " not in errors
    refused = warming.refused + attacked.refused
    assert counted_in_log(errors) == {kind.value: times for kind, times in refused.items()}


def test_two_thousand_mutated_messages_affect_no_other_client(tmp_path):
    attack(tmp_path / "records", 400, 2_000, 1)


@pytest.mark.soak
def test_a_million_mutated_messages_affect_no_other_client(tmp_path):
    attack(tmp_path / "records", 50_000, 1_000_000, 50)


def test_every_acceptable_command_is_among_those_that_are_mutated():
    assert COMMANDS.keys() == commands.COMMANDS.keys()
    for name, arguments in COMMANDS.items():
        check_arguments(name, arguments)
