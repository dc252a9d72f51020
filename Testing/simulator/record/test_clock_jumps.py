"""The computer's clock may be set while a trial runs: durations and the record are unaffected."""

import time
from datetime import datetime, timedelta
from types import SimpleNamespace

import pytest

from rastrainer.commands import CommandName, check_arguments
from rastrainer.journal import entries
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import Phase
from rastrainer.study.database.study import Study
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.core.interrupted_trial import find_interrupted
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.record.trial_archive import SUFFIX
from rastrainer_simulator.replay.resimulation import replay

TIMEOUT_S = 120.0


@pytest.fixture
def jumping(monkeypatch):
    """Return an object whose `by` is how far the clock has been set."""
    jump = SimpleNamespace(by=timedelta())

    def now(zone):
        return datetime.now(zone) + jump.by

    monkeypatch.setattr(entries, "datetime", SimpleNamespace(now=now))
    return jump


@pytest.mark.parametrize("days", [-400, 400], ids=["back", "forward"])
def test_a_clock_that_jumps_in_a_trial_changes_no_duration(
    simulation, anywhere, tmp_path, jumping, days
):
    records = tmp_path / "records"
    started = time.monotonic()
    with ControlLoop(simulation, records, speed=None) as loop:

        def do(command, **arguments):
            checked = check_arguments(command, arguments)
            answer = loop.submit(command, checked).result(TIMEOUT_S)
            assert answer.ok or command == CommandName.ABORT, answer.message

        do(CommandName.ABORT)
        do(CommandName.START_TASK, task="task-1", trainee="P01")
        while loop.latest.training.phase is Phase.RUNNING:
            do(CommandName.CAPTURE)
            jumping.by += timedelta(days=days)
        do(CommandName.REGISTER)
        (record,) = loop.archive.unacknowledged()
    (path,) = records.glob(f"*{SUFFIX}")
    reading = read_journal(path)
    assert reading.integrity is Integrity.INTACT
    assert replay(reading, anywhere).difference is None
    times = [entry["monotonicS"] for entry in reading.entries]
    assert times == sorted(times)
    assert times[-1] - times[0] <= time.monotonic() - started
    simulated = reading.entries[-1]["simTimeS"] - reading.header.before.sim_time_s
    assert 0.0 < record.completion_time_s <= simulated
    years = {point.utc[:4] for point in record.points}
    assert len(years) > 10
    assert record_from_json(TrialRecord, record_to_json(record)) == record
    with Study.open(tmp_path / "study.db") as study:
        assert study.add_trial(record)
        assert study.history("P01")[0].record.completion_time_s == record.completion_time_s


def play(loop, trainee, is_ended):
    """Begin a trial and touch two points; return its ID."""
    for command in (CommandName.ABORT, CommandName.START_TASK, *[CommandName.CAPTURE] * 2):
        words = {"task": "task-1", "trainee": trainee}
        arguments = words if command == CommandName.START_TASK else {}
        answer = loop.submit(command, check_arguments(command, arguments)).result(TIMEOUT_S)
        assert answer.ok or command == CommandName.ABORT, answer.message
    if is_ended:
        assert loop.submit(CommandName.ABORT).result(TIMEOUT_S).ok
    return loop.latest.training.trial_id


@pytest.mark.parametrize(("minutes", "restarts"), [(-5, False), (-600_000, True)])
def test_the_most_recently_started_trial_is_resumed_even_if_the_clock_was_set_back(
    simulation, tmp_path, jumping, minutes, restarts
):
    with ControlLoop(simulation, tmp_path, speed=None) as first:
        play(first, "P01", is_ended=True)
        jumping.by += timedelta(minutes=minutes)
        if not restarts:
            last = play(first, "P02", is_ended=False)
    if restarts:
        with ControlLoop(simulation, tmp_path, speed=None) as second:
            last = play(second, "P02", is_ended=False)
    names = sorted(tmp_path.glob(f"*{SUFFIX}"))
    assert last in names[0].name
    reading, interrupted = find_interrupted(tmp_path)
    assert reading.path == names[0]
    assert interrupted is not None
    assert reading.header.trainee == "P02"
    assert [read_journal(path).header.number for path in names] == [2, 1]
