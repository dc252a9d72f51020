"""Finished trials reach the study exactly once, even if connections break and both ends crash.

The server's part is the control loop, the link and the offers as they run in the simulator; the
other side's is Slicer's link, trial logic and study. The ends are connected by real sockets through
a proxy that cuts, delays and reorders messages and leaves links half-open.
"""

from __future__ import annotations

import gc
import random

import pytest

from rastrainer.journal.entries import Attempt
from rastrainer.journal.folder import SUFFIX
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.scenario.scenario import load_scenario
from rastrainer.sections.trial_logic import TrialLogic
from rastrainer.study.database.study import Study
from rastrainer.trial.record import AbortedTrial
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.net.igtl.simulator_link import SimulatorLink
from rastrainer_simulator.record.journal_writer import Journal
from rastrainer_simulator.record.trial_archive import (
    TrialArchive,
    find_unacknowledged,
)
from Testing.domain.trial.trial_records import make_aborted
from Testing.end_to_end.faulty_proxy import FaultyProxy, SlicerSide
from Testing.end_to_end.finished_trials import COLIN, TRAINEE, write_finished_trials
from Testing.journal_lines import at, header
from Testing.simulator.net.igtl.servers import HOST
from Testing.slicer.simulator_double import run_logic_until

TIMEOUT_S = 180.0
ABORTED = 2


class Server:
    """The simulator's loop and link over a folder of records."""

    def __init__(self, thread, simulation, records):
        self._thread = thread
        self._loop = ControlLoop(simulation, records, rate_hz=50.0)
        self._loop.thread.start()
        self._link = thread.call(
            SimulatorLink,
            latest=lambda: self._loop.latest,
            submit=self._loop.submit,
            unacknowledged=self._loop.archive.unacknowledged,
            arrivals=lambda: self._loop.archive.arrivals,
            find_scenario=lambda _name: load_scenario(COLIN),
        )
        self.port = thread.run(self._link.server.listen(HOST, 0))

    def offer(self):
        """Do what the heartbeat does every two seconds."""
        self._thread.call(self._link.offers.repeat)

    @property
    def undelivered(self):
        return len(self._loop.archive.unacknowledged())

    def close(self):
        self._thread.run(self._link.server.close())
        self._loop.stop()


def write_aborted_trials(folder, count):
    for number in range(1, count + 1):
        record = record_from_json(AbortedTrial, make_aborted(number, touches=number))
        journal = Journal(folder / f"20240517T0930{number:02d}Z_{record.trial_id}{SUFFIX}")
        attempt = Attempt(record_to_json(record))
        journal.write_lines([at(0.0, header(trainee="T-001")), at(0.0, attempt)], sync=False)
        journal.close()


@pytest.fixture(scope="module")
def simulation():
    return Simulation(load_setup(), 1)


@pytest.mark.parametrize(
    ("trials", "longest_s"), [(2, 0.2), pytest.param(60, 12.0, marks=pytest.mark.soak)]
)
def test_trials_arrive_exactly_once_through_faults_and_restarts_on_both_sides(
    simulation, loop_thread, tmp_path, trials, longest_s
):
    rng, ends, scored = random.Random(2), [0, 0], []
    records, study = tmp_path / "records", tmp_path / "study.db"
    wanted = write_finished_trials(records, range(1, trials + 1))
    write_aborted_trials(records, ABORTED)
    scenario = load_scenario(COLIN)
    server = Server(loop_thread, simulation, records)
    proxy = FaultyProxy(server.port, rng, longest_s, at_least=3)

    def slicer_side():
        side = SlicerSide(study, proxy.port, TrialLogic, lambda _name: scenario)
        side.logic.trialScored.connect(lambda trial: scored.append(trial.record.trial_id))
        return side

    slicer = slicer_side()
    try:
        while server.undelivered or 0 in ends:
            # Offers in every turn would use up each connection before an answer.
            if rng.random() < 0.3:
                server.offer()
            slicer.run_for(rng.randrange(5, 60))
            if rng.random() < 0.04:
                ends[0] += 1
                slicer.close()
                # Nothing is collected by itself within a test, and many trials take much memory.
                gc.collect()
                slicer = slicer_side()
            if rng.random() < 0.04:
                ends[1] += 1
                server.close()
                server = Server(loop_thread, simulation, records)
                proxy.target = server.port
        proxy.stop_faults()
        slicer.close()
        slicer = slicer_side()
        with Study.open(study) as opened:
            run_logic_until(slicer.link, slicer.work, lambda: not opened.unrevealed(), TIMEOUT_S)
    finally:
        slicer.close()
        proxy.close()
        server.close()
    with Study.open(study) as opened:
        stored = [trial.record.trial_id for trial in opened.history(TRAINEE)]
        aborted = [len(each.points) for each in opened.aborted("T-001")]
    assert sorted(stored) == sorted(scored) == sorted(wanted)
    assert sorted(aborted) == list(range(1, ABORTED + 1))
    assert TrialArchive(records).unacknowledged() == ()
    assert find_unacknowledged(records) == []
    assert sum(proxy.faults.values()) >= 3
