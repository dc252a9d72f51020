"""The computer's clock may be set while a trial runs: durations and the record are unaffected."""

import time
from datetime import datetime, timedelta
from types import SimpleNamespace

import pytest

from rastrainer.commands import CommandName
from rastrainer.journal import entries
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.protocol import Phase
from rastrainer.study.database.study import Study
from rastrainer_simulator.core.interrupted_trial import find_interrupted
from rastrainer_simulator.record.trial_archive import SUFFIX
from rastrainer_simulator.replay.resimulation import replay
from Testing.simulator.record.test_interrupted_trial import Server


@pytest.fixture
def jumping(monkeypatch):
    """Return an object whose `by` is how far the clock has been set."""
    jump = SimpleNamespace(by=timedelta())

    def now(zone):
        return datetime.now(zone) + jump.by

    monkeypatch.setattr(entries, "datetime", SimpleNamespace(now=now))
    return jump


def test_a_clock_that_jumps_back_in_a_trial_changes_no_duration(
    simulation, anywhere, tmp_path, jumping
):
    started = time.monotonic()
    with Server(simulation, tmp_path / "records") as server:
        server.start()
        while server.training.phase is Phase.RUNNING:
            assert server.do(CommandName.CAPTURE).ok
            jumping.by -= timedelta(days=400)
        assert server.do(CommandName.REGISTER).ok
        (record,) = server.loop.archive.unacknowledged()
    reading = read_journal(server.path)
    assert reading.integrity is Integrity.INTACT
    assert replay(reading, anywhere).difference is None
    times = [entry["monotonicS"] for entry in reading.entries]
    assert times == sorted(times)
    assert times[-1] - times[0] <= time.monotonic() - started
    simulated = reading.entries[-1]["simTimeS"] - reading.header.before.sim_time_s
    assert 0.0 < record.completion_time_s <= simulated
    assert len({point.utc[:4] for point in record.points}) > 10
    with Study.open(tmp_path / "study.db") as study:
        assert study.add_trial(record)
        assert study.history("P01")[0].record.completion_time_s == record.completion_time_s


def test_the_most_recently_started_trial_is_resumed_even_if_the_clock_was_set_back(
    simulation, tmp_path, jumping
):
    with Server(simulation, tmp_path) as server:
        server.start()
        assert server.do(CommandName.ABORT).ok
    jumping.by -= timedelta(days=400)
    with Server(simulation, tmp_path) as server:
        start = {"task": "task-1", "trainee": "P02"}
        last = server.do(CommandName.START_TASK, **start).data["trialId"]
        assert server.do(CommandName.CAPTURE).ok
    names = sorted(tmp_path.glob(f"*{SUFFIX}"))
    assert last in names[0].name
    reading, interrupted = find_interrupted(tmp_path)
    assert reading.path == names[0]
    assert interrupted is not None
    assert reading.header.trainee == "P02"
    assert [read_journal(path).header.number for path in names] == [2, 1]
