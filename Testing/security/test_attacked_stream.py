"""At worst, a view's message ends that view."""

import pytest

from rastrainer.igtl.client import Client
from Testing.end_to_end.simulator_process import ViewedSimulator
from Testing.security.attacked_process import cost_of, is_unharmed, settled
from Testing.security.stream_attack import StreamAttack
from Testing.simulator.net.igtl.servers import LoopThread
from Testing.simulator.net.views.served import ViewClient


def attack(folder, warm_up: int, count: int) -> None:
    arguments = (folder, "--view-port", "0", "--seed", "1")
    with (
        LoopThread() as thread,
        ViewedSimulator(*arguments) as simulator,
        Client(port=simulator.port) as slicer,
        ViewClient(thread, simulator.url, simulator.key) as view,
    ):
        view.join()
        # Building a scene, and the imports after it, belong to no attack.
        view.next("scene")
        slicer.wait_for("SimServer", timeout=60)
        attacked = StreamAttack(simulator.view_port, simulator.key, seed=7)
        attacked.run(warm_up)
        # Memory reserved once is no leak: a leak would grow at the next attack, too.
        for _ in range(3):
            before = settled(simulator.pid, slicer, cost_of(simulator.pid, slicer))
            attacked.run(count)
            after = settled(simulator.pid, slicer, before)
            if is_unharmed(before, after):
                break
        assert is_unharmed(before, after), (before, after)
        assert attacked.closed == attacked.mutated >= warm_up + count
        assert view.next("state")["type"] == "state"
        status, errors = simulator.stop()
    assert status == 0
    assert "Traceback" not in errors
    assert " ERROR " not in errors


def test_sixty_mutated_view_messages_affect_no_other_view(tmp_path):
    attack(tmp_path / "records", 60, 60)


@pytest.mark.soak
def test_ten_thousand_mutated_view_messages_affect_no_other_view(tmp_path):
    attack(tmp_path / "records", 3_000, 10_000)
