"""Many OpenIGTLink clients at 60 Hz and views at once are all served."""

from __future__ import annotations

import multiprocessing

import pytest

from Testing.benchmarks.crowd import CLIENTS, VIEWS, serve_crowd
from Testing.end_to_end.simulator_process import ViewedSimulator

SECONDS = 2.0
TIMEOUT_S = 120.0


@pytest.mark.soak
@pytest.mark.parametrize(("clients", "views"), [(30, 5), (CLIENTS, VIEWS)])
def test_many_clients_and_views_at_once_are_all_served(tmp_path, clients, views):
    begin = multiprocessing.get_context("spawn")
    results = begin.Queue()
    with ViewedSimulator(tmp_path / "records", "--view-port", "0") as simulator:
        address = (simulator.port, simulator.view_port, simulator.key)
        asked = (address, SECONDS, results, clients, views)
        crowd = begin.Process(target=serve_crowd, args=asked, daemon=True)
        crowd.start()
        served = results.get(timeout=TIMEOUT_S)
        crowd.join()
    assert served.dropped == served.lost == 0
    assert len(served.echoes) == clients
    assert all(served.echoes)
    assert all(served.poses)
    assert len(served.states) == views
    assert all(served.states)
