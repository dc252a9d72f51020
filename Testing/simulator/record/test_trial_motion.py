"""A trial's motion metrics are the same while it runs, in its record and from its journal."""

import json
import threading
from concurrent.futures import ThreadPoolExecutor

import pytest

from rastrainer.journal.journal_file import read_journal
from rastrainer.journal.recording import Recording
from rastrainer.json_records import record_from_json
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.cli.main import main
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.record import trial_records
from rastrainer_simulator.record.trial_archive import TrialArchive
from rastrainer_simulator.record.trial_recorder import TrialRecorder
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.play import play_virtual_trial

DT = 0.02
BRISK = Skill(speed_mm_s=300.0, gain_per_s=6.0, reaction_s=0.1, dwell_s=0.04)


@pytest.fixture(scope="module")
def played(setup, tmp_path_factory):
    """Play and record a whole trial; return its journal, and the threads that measured it."""
    folder, threads = tmp_path_factory.mktemp("records"), []

    def measure(trajectory):
        threads.append(threading.current_thread())
        return trial_motion(trajectory)

    with pytest.MonkeyPatch.context() as patch, ThreadPoolExecutor(1) as writer:
        patch.setattr(trial_records, "trial_motion", measure)
        recorder = TrialRecorder(folder, TrialArchive(folder), writer, DT)
        play_virtual_trial(Simulation(setup, 5), "task-1", 3, BRISK, DT, recorder.record)
        writer.submit(int).result()
    (path,) = folder.glob("*.journal")
    return read_journal(path), threads


@pytest.fixture
def journal(played):
    return played[0]


def test_the_register_tick_leaves_the_metrics_to_the_journal_writer(played):
    (thread,) = played[1]
    assert thread is not threading.main_thread()


def test_the_record_has_the_same_metrics_as_the_journal_to_the_last_bit(journal):
    (registered,) = journal.of_kind("registered")
    record = record_from_json(TrialRecord, registered["record"])
    assert len(record.motion) > 20
    assert record.motion == trial_motion(Recording.of(journal.lines()).trajectory())
    assert record.motion["completion_time_s"] == pytest.approx(record.completion_time_s, abs=1e-9)
    assert record.motion["undone_touches"] == record.undone_touches
    assert record.motion["contacts"] >= 15
    assert 0.2 < record.motion["path_efficiency"] < 1.0


def test_the_command_measures_a_journal(journal, capsys):
    assert main(["measure", str(journal.path), "--json"]) == 0
    (registered,) = journal.of_kind("registered")
    assert json.loads(capsys.readouterr().out) == registered["record"]["motion"]
    assert main(["measure", str(journal.path), "--explain"]) == 0
    text = capsys.readouterr().out
    assert "Smoothness, SPARC" in text
    assert "Balasubramanian" in text
