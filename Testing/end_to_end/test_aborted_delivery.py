"""Aborted trials reach the study exactly once, whatever becomes of connections and both ends."""

from __future__ import annotations

import random
import time

import pytest

from rastrainer.aborted_trial import AbortedTrial
from rastrainer.journal.folder import SUFFIX
from rastrainer.journal.journal_line import FORMAT, FORMAT_VERSION
from rastrainer.slicer.aborted_desk import AbortedDesk
from rastrainer.slicer.background_work import BackgroundWork
from rastrainer.slicer.headless_kit import headlessKit
from rastrainer.slicer.headless_scene import HeadlessScene
from rastrainer.slicer.link import Link
from rastrainer.study import Study
from rastrainer.study_aborted import AbortedTrials
from rastrainer_simulator.record.aborted_archive import attempt_entry
from rastrainer_simulator.record.journal import Journal
from rastrainer_simulator.record.stamps import stamp
from rastrainer_simulator.record.trial_archive import TrialArchive, find_unacknowledged
from rastrainer_simulator.setup import load_setup
from rastrainer_simulator.simulation import Simulation
from Testing.domain.aborted_records import make_aborted
from Testing.end_to_end.faulty_proxy import FaultyProxy
from Testing.end_to_end.test_delivery import Server
from Testing.slicer.simulator_double import process_link

TRIALS = 12


class SlicerSide:
    """Link, desk and study, as Slicer has them."""

    def __init__(self, path, port):
        self.link = Link(HeadlessScene().scene, headlessKit)
        self.work = BackgroundWork()
        self.desk = AbortedDesk(self.link, lambda: Study.open(path), self.work)
        self.link.connectTo(port=port)

    def run_for(self, steps):
        for _ in range(steps):
            process_link(self.link)
            self.work.process()
            time.sleep(0.002)

    def close(self):
        self.desk.close()
        self.work.close()
        self.link.disconnect()


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
    slicer = SlicerSide(study, proxy.port)
    ends = [0, 0]
    try:
        while server.undelivered or min(ends) < 2:
            server.offer()
            slicer.run_for(rng.randrange(5, 60))
            if rng.random() < 0.2:
                ends[0] += 1
                slicer.close()
                slicer = SlicerSide(study, proxy.port)
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
