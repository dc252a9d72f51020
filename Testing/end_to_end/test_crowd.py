"""A hundred OpenIGTLink clients at 60 Hz and twenty views at once are all served."""

from __future__ import annotations

import multiprocessing
import secrets

from Testing.benchmarks.bare_loop import BareLoop
from Testing.benchmarks.crowd import CLIENTS, VIEWS, serve_crowd
from Testing.end_to_end.viewed_simulator import ViewedSimulator
from Testing.security.attacked_process import MOST_MORE_MISSED

SECONDS = 3.0
PATIENCE_S = 120.0


def test_a_hundred_clients_and_twenty_views_are_all_served_and_the_loop_keeps_its_ticks(tmp_path):
    key = secrets.token_urlsafe()
    begin = multiprocessing.get_context("spawn")
    results = begin.Queue()
    with ViewedSimulator(tmp_path / "records", "--view-port", "0", key=key) as simulator:
        ports = (simulator.port, simulator.view_port)
        crowd = begin.Process(target=serve_crowd, args=(*ports, key, SECONDS, results), daemon=True)
        crowd.start()
        with BareLoop() as bare:
            served = results.get(timeout=PATIENCE_S)
        crowd.join()
    assert served.dropped == served.lost == 0
    assert len(served.echoes) == CLIENTS
    assert all(served.echoes)
    assert all(served.tool_tips)
    assert len(served.states) == VIEWS
    assert all(served.states)
    assert served.on_time >= bare.punctuality.on_time - MOST_MORE_MISSED
