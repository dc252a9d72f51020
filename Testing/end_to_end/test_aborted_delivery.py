"""Aborted trials reach the study exactly once, whatever becomes of connections and both ends."""

from __future__ import annotations

import random

import pytest

from rastrainer.journal.folder import SUFFIX
from rastrainer.journal.journal_file import FORMAT, FORMAT_VERSION
from rastrainer.slicer.logic.trial_delivery import AbortedTrialsLogic
from rastrainer.study.database.aborted_trials import AbortedTrials
from rastrainer.study.database.study import Study
from rastrainer.trial.aborted_trial import AbortedTrial
from rastrainer_simulator.core.setup import load_setup
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.ops.stamps import stamp
from rastrainer_simulator.record.aborted_archive import attempt_entry
from rastrainer_simulator.record.journal import Journal
from rastrainer_simulator.record.trial_archive import TrialArchive, find_unacknowledged
from Testing.domain.trial.trial_records import make_aborted
from Testing.end_to_end.faulty_proxy import FaultyProxy
from Testing.end_to_end.slicer_side import SlicerSide
from Testing.end_to_end.test_delivery import Server

TRIALS = 12


def slicer_side(path, port):
    return SlicerSide(
        path,
        port,
        lambda _scene, link, open_study, work: AbortedTrialsLogic(link, open_study, work),
    )


def write_aborted_trials(folder):
    folder.mkdir()
    header = {"kind": "header", "format": FORMAT, "version": FORMAT_VERSION, "seed": 7}
    for number in range(1, TRIALS + 1):
        record = AbortedTrial.from_json(make_aborted(number, touches=number))
        journal = Journal(folder / f"20240517T0930{number:02d}Z_{record.trial_id}{SUFFIX}")
        entries = [header | {"trainee": "T-001"}, attempt_entry(record, stamp(1, 0.0))]
        journal.write(entries, sync=False)
        journal.close()


@pytest.fixture(scope="module")
def simulation():
    return Simulation(load_setup(), 1)


def test_they_arrive_exactly_once_through_faults_and_ends_of_both_sides(
    simulation, loop_thread, tmp_path
):
    rng = random.Random(6)
    records, study = tmp_path / "records", tmp_path / "study.db"
    write_aborted_trials(records)
    server = Server(loop_thread, simulation, records)
    proxy = FaultyProxy(server.port, rng, 0.2)
    slicer = slicer_side(study, proxy.port)
    ends = [0, 0]
    try:
        while server.undelivered or min(ends) < 2:
            server.offer()
            slicer.run_for(rng.randrange(5, 60))
            if rng.random() < 0.2:
                ends[0] += 1
                slicer.close()
                slicer = slicer_side(study, proxy.port)
            if rng.random() < 0.2:
                ends[1] += 1
                server.close()
                server = Server(loop_thread, simulation, records)
                proxy.target = server.port
    finally:
        slicer.close()
        proxy.close()
        server.close()
    with Study.open(study) as opened:
        stored = AbortedTrials(opened).of("T-001")
    assert sorted(len(each.record.points) for each in stored) == list(range(1, TRIALS + 1))
    assert TrialArchive(records).unacknowledged() == ()
    assert find_unacknowledged(records) == []
