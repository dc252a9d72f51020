"""The control loop: owns the time, publishes nothing that is not on the disk, loses nothing."""

import os
import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from rastrainer.commands import CommandName, check_arguments
from rastrainer.journal.entries import AcceptedTouch
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.json_records import record_from_json
from rastrainer.protocol import Phase
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.loop import control_loop
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.loop.timing import TrialLimits
from rastrainer_simulator.record.trial_archive import SUFFIX
from rastrainer_simulator.replay.resimulation import replay
from rastrainer_simulator.state import OperatorCommand, OperatorInput, StepResult
from Testing.simulator.record.test_interrupted_trial import on_full_disk

TIMEOUT_S = 120.0
SPEED = 20.0
"""For most loops: at full speed, a loop would fill journals while a test waits for the disk."""


@pytest.fixture(scope="module")
def shared(anywhere):
    return Simulation(anywhere, 3)


class Client:
    """Submits commands to a loop and waits for the answers."""

    def __init__(self, loop):
        self.loop = loop

    def do(self, command, **arguments):
        return self.submit(command, **arguments).result(TIMEOUT_S)

    def submit(self, command, **arguments):
        return self.loop.submit(command, check_arguments(command, arguments), "tester")

    def start(self, **others):
        answer = self.do(CommandName.START_TASK, task="task-1", trainee="P01", **others)
        assert answer.ok, answer.message
        return answer.data["trialId"]

    def finish(self):
        while self.loop.latest.training.phase is Phase.RUNNING:
            assert self.do(CommandName.CAPTURE).ok
        assert self.do(CommandName.REGISTER).ok

    def register(self, trial_id):
        return self.do(
            CommandName.SUBMIT_REGISTRATION,
            trialId=trial_id,
            matrix=np.eye(4).ravel().tolist(),
            freMm=1.0,
            expectedTreMm=1.0,
        )

    def score(self, trial_id):
        return self.do(CommandName.TRIAL_SCORED, trialId=trial_id, score=70.0)

    def ticks(self, count):
        """Wait until a number of further ticks have been published."""
        until = self.loop.latest.tick + count
        wait_for(lambda: self.loop.latest.tick >= until)


def wait_for(condition):
    give_up = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < give_up, "it never came true"
        time.sleep(0.001)


@pytest.fixture(scope="module")
def shared_successor(anywhere):
    return Simulation(anywhere, 4)


@pytest.fixture
def successor(shared_successor):
    """Another simulation, between two trials."""
    shared_successor.step(0.004, OperatorInput(commands=(OperatorCommand(CommandName.ABORT),)))
    return shared_successor


@pytest.fixture
def running(shared, tmp_path):
    """Return a client of a loop around the shared simulation, between two trials."""
    shared.step(0.004, OperatorInput(commands=(OperatorCommand(CommandName.ABORT),)))
    with ControlLoop(shared, tmp_path / "records", speed=SPEED) as loop:
        yield Client(loop)


def journals(folder):
    return sorted((folder / "records").glob(f"*{SUFFIX}"))


def labels(reading):
    return [entry["label"] for entry in reading.of_kind("touch")]


def test_a_whole_trial_is_recorded_delivered_scored_and_replayed_bit_for_bit(
    running, tmp_path, anywhere
):
    sticks = OperatorInput(translation=(0.3, -0.2, -0.9), operator="gamepad")
    trial_id = running.start()
    for number in range(5):
        running.loop.hold_sticks(replace(sticks, fine=number % 3 == 0))
        running.ticks(12)
        assert running.do(CommandName.CAPTURE).ok
    assert running.do(CommandName.UNDO).ok
    futures = [running.submit(CommandName.CAPTURE) for _ in range(11)]
    assert all(future.result(TIMEOUT_S).ok for future in futures)
    assert running.do(CommandName.REGISTER).ok
    assert [record.trial_id for record in running.loop.archive.unacknowledged()] == [trial_id]
    assert "headToWorld" not in running.do(CommandName.GET_TRIAL, trialId=trial_id).data
    assert running.do(CommandName.ACKNOWLEDGE_TRIAL, trialId=trial_id).ok
    assert running.loop.archive.unacknowledged() == ()
    answer = running.register(trial_id)
    assert running.score(trial_id).ok
    assert running.loop.latest.training.phase is Phase.SCORED
    trial = running.do(CommandName.GET_TRIAL, trialId=trial_id).data
    assert trial["headToWorld"] == answer.data["headToWorld"]
    running.loop.stop()

    (path,) = journals(tmp_path)
    reading = read_journal(path)
    assert reading.integrity is Integrity.INTACT
    assert labels(reading) == ["1", "2", "3", "4", "5", *map(str, range(5, 16))]
    report = replay(reading, anywhere)
    assert report.difference is None
    assert report.compared["sample"] > 20
    assert report.motion["undone_touches"] == 1
    assert report.motion == trial["record"]["motion"]
    record = record_from_json(TrialRecord, trial["record"])
    assert record.undone_touches == 1


def test_nobody_sees_a_touch_before_it_is_on_disk_and_the_arm_continues_meanwhile(
    running, monkeypatch
):
    running.start()
    seen: list[StepResult] = []
    running.loop.subscribe(seen.append)
    may_sync = threading.Event()
    fsync = os.fsync
    monkeypatch.setattr(os, "fsync", lambda descriptor: (may_sync.wait(), fsync(descriptor)))
    running.loop.hold_sticks(OperatorInput(translation=(1.0, 0.0, 0.0)))
    answer = running.submit(CommandName.CAPTURE)
    running.ticks(40)
    before = running.loop.latest
    assert not answer.done()
    assert before.training.touches == ()
    assert len({result.state.q for result in seen}) > 30
    assert not any(
        isinstance(event.entry, AcceptedTouch) for result in seen for event in result.events
    )
    may_sync.set()
    assert answer.result(TIMEOUT_S).ok
    wait_for(lambda: len(running.loop.latest.training.touches) == 1)
    # Subscribers receive a tick after it has become the latest.
    wait_for(lambda: len(seen[-1].state.training.touches) == 1)
    assert (
        sum(isinstance(event.entry, AcceptedTouch) for result in seen for event in result.events)
        == 1
    )


def test_a_trial_whose_journal_cannot_be_made_does_not_start(running, tmp_path):
    records = tmp_path / "records"
    records.write_text("a file where the folder should be")
    answer = running.do(CommandName.START_TASK, task="task-1", trainee="P01")
    assert not answer.ok
    assert "could not be recorded" in answer.message
    wait_for(lambda: "cannot be recorded" in running.loop.latest.training.instruction)
    assert running.loop.latest.training.phase is Phase.IDLE
    records.unlink()
    running.start()
    assert len(journals(tmp_path)) == 1


def test_on_a_full_disk_the_trial_pauses_and_continues_once_there_is_room(
    running, tmp_path, anywhere, monkeypatch
):
    running.start()
    running.loop.hold_sticks(OperatorInput(translation=(0.5, -0.5, 0.0)))
    assert running.do(CommandName.CAPTURE).ok

    with monkeypatch.context() as patch:
        patch.setattr(os, "write", on_full_disk)
        refused = running.do(CommandName.CAPTURE)
        wait_for(lambda: running.loop.latest.training.phase is Phase.PAUSED)
        still_full = running.do(CommandName.RESUME)
    assert not refused.ok
    assert not still_full.ok
    assert "No space left on device" in still_full.message
    wait_for(lambda: running.loop.latest.training.phase is Phase.PAUSED)
    assert len(running.loop.latest.training.touches) == 1
    assert "No space left on device" in running.loop.latest.training.instruction

    assert running.do(CommandName.RESUME).ok
    assert running.do(CommandName.CAPTURE).data["label"] == "2"
    running.finish()
    running.loop.stop()
    reading = read_journal(journals(tmp_path)[0])
    assert reading.integrity is Integrity.INTACT
    assert replay(reading, anywhere).difference is None
    record = record_from_json(TrialRecord, reading.of_kind("registered")[-1]["record"])
    assert record.labels == tuple(str(i) for i in range(1, 16))


def test_stopping_in_the_middle_of_a_trial_marks_it_and_refuses_late_commands(running, tmp_path):
    running.start()
    running.do(CommandName.CAPTURE)
    running.loop.stop()
    reading = read_journal(journals(tmp_path)[0])
    assert reading.integrity is Integrity.INTACT
    assert reading.entries[-1]["kind"] == "stopped"
    assert "shutting down" in running.do(CommandName.CAPTURE).message


def test_a_trial_requested_before_the_replacement_starts_and_none_requested_after_it_does(
    running, successor
):
    commands = (CommandName.START_TASK, {"task": "task-1", "trainee": "P01", "mode": "desktop"})
    answers = [
        running.loop.submit(*commands),
        running.loop.begin_replacement(),
        running.submit(CommandName.ABORT),
        running.loop.begin_replacement(),
        running.loop.submit(*commands),
    ]
    found = [answer.result(TIMEOUT_S) for answer in answers]
    assert [answer.ok for answer in found] == [True, False, True, True, False]
    assert found[1].message == control_loop.TRIAL_IS_OPEN
    assert found[-1].message == control_loop.BEING_SET_UP
    tick = running.loop.latest.tick
    assert running.loop.replace_simulation(successor).result(TIMEOUT_S).ok
    running.loop.end_replacement()
    running.ticks(3)
    assert running.loop.latest.tick > tick
    running.start()


def test_the_simulation_is_replaced_only_once_the_last_trials_score_is_on_disk(
    running, successor, monkeypatch
):
    trial_id = running.start()
    running.finish()
    assert running.register(trial_id).ok
    assert running.loop.begin_replacement().result(TIMEOUT_S).ok
    may_sync, fsync = threading.Event(), os.fsync
    monkeypatch.setattr(os, "fsync", lambda descriptor: (may_sync.wait(), fsync(descriptor)))
    score = running.submit(CommandName.TRIAL_SCORED, trialId=trial_id, score=70.0)
    wait_for(lambda: running.loop._held.is_waiting)
    handover = running.loop.replace_simulation(successor)
    running.ticks(20)
    assert not handover.done()
    may_sync.set()
    assert score.result(TIMEOUT_S).ok
    assert handover.result(TIMEOUT_S).ok


def test_trials_started_too_often_are_refused_and_create_no_journal(successor, tmp_path):
    places = (successor, tmp_path / "records")
    with ControlLoop(*places, speed=None, trial_limits=TrialLimits(1e-6, 2)) as loop:
        client = Client(loop)
        for _ in range(2):
            client.start()
            client.do(CommandName.ABORT)
        refused = client.do(CommandName.START_TASK, task="task-1", trainee="P01")
        assert not refused.ok
        assert refused.message.key == "too many starts"
        assert loop.latest.training.phase is Phase.IDLE
    assert len(journals(tmp_path)) == 2


class SteppedClock:
    """Time that passes only while the loop sleeps or is held up: no machine stalls in it."""

    def __init__(self):
        self.now = 100.0

    def monotonic(self):
        return self.now

    def sleep_until(self, moment):
        self.now = max(self.now, moment)


@pytest.mark.parametrize(("held_up_s", "late", "skipped"), [(0.062, 15, 0), (0.502, 1, 124)])
def test_after_a_delay_the_loop_catches_up_tick_by_tick_or_counts_the_lost_ticks(
    successor, tmp_path, monkeypatch, held_up_s, late, skipped
):
    clock = SteppedClock()
    monkeypatch.setattr(control_loop, "time", clock)
    monkeypatch.setattr(control_loop, "sleep_until", clock.sleep_until)
    with ControlLoop(successor, tmp_path, speed=1.0) as loop:
        held_up = threading.Event()

        def hold_up_once(_result):
            if not held_up.is_set():
                held_up.set()
                clock.now += held_up_s

        loop.subscribe(hold_up_once)
        wait_for(held_up.is_set)
        Client(loop).ticks(100)
        # 58 ms behind, then 54, …, 2; or 498 ms, of which half a tick is caught up.
        assert (loop.statistics.late, loop.statistics.skipped) == (late, skipped)


def test_a_faulty_subscriber_stops_the_loop_and_every_request_is_still_answered(
    successor, tmp_path, caplog
):
    with ControlLoop(successor, tmp_path, speed=None) as loop:
        loop.subscribe(lambda _result: 1 / 0)
        wait_for(lambda: not loop.thread.is_alive())
        assert not Client(loop).do(CommandName.LIST_TASKS).ok
    assert "ZeroDivisionError" in caplog.text
