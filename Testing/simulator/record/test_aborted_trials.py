"""An aborted trial is stored and offered until a client has it: no touch disappears."""

import json
import os
import random
import shutil
import uuid
from dataclasses import replace

import pytest

from rastrainer.commands import CommandName
from rastrainer.journal.entries import AcceptedTouch
from rastrainer.journal.journal_file import SEED_SUFFIX, Integrity, read_journal
from rastrainer.journal.recording import Recording, read_track
from rastrainer.protocol import Phase
from rastrainer.study.database.study import Study
from rastrainer.trial.record import AbortedTrial, TrialRecord
from rastrainer_simulator.core.interrupted_trial import find_interrupted
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.record.trial_archive import (
    SUFFIX,
    TrialArchive,
    find_unacknowledged,
    interrupted_attempt,
)
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.replay.resimulation import replay
from Testing.simulator.record.test_interrupted_trial import Server, cut, on_full_disk


class Restarted(Server):
    """A server that was started with `--no-resume`."""

    def __init__(self, simulation, folder):
        self._take(ControlLoop(simulation, folder, speed=None), folder)


def touch(server, count):
    for _ in range(count):
        assert server.do(CommandName.CAPTURE).ok


def wait_for_offer(server):
    """Return the offered records once everything before is written."""
    server.write()
    return server.loop.archive.unacknowledged()


def test_an_aborted_trial_is_offered_with_its_touches_until_acknowledged_even_after_a_restart(
    simulation, anywhere, tmp_path
):
    with Server(simulation, tmp_path) as server:
        trial_id = server.start()
        touch(server, 3)
        assert server.do(CommandName.UNDO).ok
        assert server.do(CommandName.ABORT, reason="trainee").ok
        (record,) = wait_for_offer(server)
    assert isinstance(record, AbortedTrial)
    assert (record.trial_id, record.trainee, record.task) == (trial_id, "P01", "task-1")
    assert (record.reason, record.phase) == ("trainee", "running")
    assert [point.label for point in record.points] == ["1", "2"]
    assert record.undone_touches == 1
    reading = read_journal(server.path)
    assert reading.integrity is Integrity.INTACT
    assert replay(reading, anywhere).difference is None
    touched = reading.of_kind("touch")
    assert [list(point.position_mm) for point in record.points] == [
        entry["positionMm"] for entry in touched[:2]
    ]
    with Server(simulation, tmp_path) as server:
        assert server.loop.archive.unacknowledged() == (record,)
        assert server.do(CommandName.ACKNOWLEDGE_TRIAL, trialId=trial_id).ok
        assert server.do(CommandName.ACKNOWLEDGE_TRIAL, trialId=trial_id).ok
        assert server.loop.archive.unacknowledged() == ()
    assert len(read_journal(server.path).of_kind("acknowledged")) == 1
    assert TrialArchive(tmp_path).unacknowledged() == ()
    assert replay(read_journal(server.path), anywhere).difference is None


def test_a_trial_that_was_only_viewed_is_delivered_for_its_number_alone(simulation, tmp_path):
    with Server(simulation, tmp_path) as server:
        server.start()
        server.move(ticks=5)
        assert server.do(CommandName.ABORT).ok
        (record,) = wait_for_offer(server)
    assert not record.is_kept
    assert read_journal(server.path).integrity is Integrity.INTACT
    with Study.open(tmp_path / "study.db") as study:
        assert not study.add_aborted(record)
        assert study.trainees() == ()
        later = replace(record, trial_id=str(uuid.UUID(int=9)), number=4, elapsed_s=20.0)
        assert study.add_aborted(later)
        assert study.undelivered() == {record.series: ((2, 3),)}


def disk_full_from_the_abort():
    """Return a write that fails from the abort on: the states before it come at any moment."""
    write, is_full = os.write, []

    def on_disk(descriptor, content):
        if is_full or b"Abort" in bytes(content) or b'"attempt"' in bytes(content):
            is_full.append(True)
            return on_full_disk(descriptor, content)
        return write(descriptor, content)

    return on_disk


def test_an_aborted_trial_that_a_full_disk_could_not_take_is_offered_and_written_later(
    simulation, anywhere, tmp_path, monkeypatch
):
    with Server(simulation, tmp_path) as server:
        trial_id = server.start()
        touch(server, 2)
        with monkeypatch.context() as patch:
            patch.setattr(os, "write", disk_full_from_the_abort())
            server.do(CommandName.ABORT)
            (record,) = wait_for_offer(server)
            refused = server.do(CommandName.ACKNOWLEDGE_TRIAL, trialId=trial_id)
            assert "No space left" in refused.message
        assert server.loop.archive.unacknowledged() == (record,)
        path = server.path
        server.start()
        assert server.do(CommandName.ACKNOWLEDGE_TRIAL, trialId=trial_id).ok
    assert (record.trial_id, len(record.points)) == (trial_id, 2)
    reading = read_journal(path)
    assert reading.integrity is Integrity.INTACT
    assert len(reading.of_kind("attempt")) == 1
    assert find_unacknowledged(tmp_path) == []
    assert replay(reading, anywhere).difference is None


def test_of_two_simultaneous_commands_that_end_a_trial_only_one_takes_effect(simulation, tmp_path):
    """A trainee registers while a client aborts: there is one record, of the first command."""
    kinds = []
    with Server(simulation, tmp_path) as server:
        for commands in (
            (CommandName.REGISTER, CommandName.ABORT, CommandName.ABORT),
            (CommandName.ABORT, CommandName.REGISTER, CommandName.ABORT),
        ):
            trial_id = server.start()
            touch(server, 15)
            arguments = {CommandName.ABORT: {"trialId": trial_id}}
            sent = [server.loop.submit(name, arguments.get(name)) for name in commands]
            assert [server.answers(one).ok for one in sent] == [True, False, False]
            found = [one for one in wait_for_offer(server) if one.trial_id == trial_id]
            kinds += [type(one) for one in found]
    assert kinds == [TrialRecord, AbortedTrial]


def test_the_truth_of_an_aborted_trial_is_never_revealed(simulation, tmp_path):
    with Server(simulation, tmp_path) as server:
        trial_id = server.start()
        touch(server, 15)
        server.do(CommandName.ABORT)
        for _ in range(2):
            answer = server.do(CommandName.GET_TRIAL, trialId=trial_id)
            assert answer.data["phase"] == "aborted"
            assert not {"headToWorld", "trueTreMm", "seed"} & answer.data.keys()
            matrix = [float(i % 5 == 0) for i in range(16)]
            refused = server.do(
                CommandName.SUBMIT_REGISTRATION,
                trialId=trial_id,
                matrix=matrix,
                freMm=0.0,
                expectedTreMm=0.0,
            )
            assert not refused.ok
            assert "was aborted" in refused.message
            server.do(CommandName.ACKNOWLEDGE_TRIAL, trialId=trial_id)
    text = server.path.read_text()
    assert json.loads(text.splitlines()[-1])["kind"] == "acknowledged"


def test_ending_the_simulator_and_starting_another_trial_aborts_the_first(simulation, tmp_path):
    with Server(simulation, tmp_path) as server:
        trial_id = server.start()
        touch(server, 4)
        server.do(CommandName.UNDO)
        server.move(ticks=50)
        server.loop.stop()
        elapsed = server.loop.latest.elapsed
        left = server.path
    with Restarted(simulation, tmp_path) as server:
        assert server.loop.archive.unacknowledged() == ()
        server.start()
        (record,) = wait_for_offer(server)
        assert (record.trial_id, record.reason) == (trial_id, "abandoned")
        assert (record.phase, len(record.points), record.undone_touches) == ("running", 3, 1)
        assert record.elapsed_s == pytest.approx(elapsed, abs=0.05)
        assert server.do(CommandName.ACKNOWLEDGE_TRIAL, trialId=trial_id).ok
    assert [entry["kind"] for entry in read_journal(left).entries[-3:]] == [
        "stopped",
        "attempt",
        "acknowledged",
    ]
    assert trial_id not in {record.trial_id for record in TrialArchive(tmp_path).unacknowledged()}


def test_a_journal_cut_at_any_byte_keeps_every_complete_touch(simulation, tmp_path):
    """The trial can be resumed with these touches, and is recorded with them if it is not."""
    original = tmp_path / "original"
    with Server(simulation, original) as server:
        server.start()
        touch(server, 6)
        server.do(CommandName.UNDO)
        server.do(CommandName.PAUSE)
        server.do(CommandName.RESUME)
        touch(server, 10)
    data = server.path.read_bytes()
    rng = random.Random(4)
    sizes = [data.index(b"\n") + 10, *(rng.randrange(len(data)) for _ in range(5))]
    for number, size in enumerate(sizes):
        folder = tmp_path / str(number)
        folder.mkdir()
        path = folder / server.path.name
        shutil.copy(server.path, path)
        shutil.copy(server.path.with_suffix(SEED_SUFFIX), folder)
        cut(path, size)
        found = find_interrupted(folder)
        record = interrupted_attempt(read_journal(path))
        whole = read_journal(path).of_kind("phase")
        assert (record is None) == (found is None) == (not whole)
        if found is not None:
            simulation.resume_trial(found[1])
            training = simulation.state.training
            kept = [touch.label for touch in training.touches]
            lines = tuple(read_journal(path).lines())
            assert kept == [touch.label for touch in Recording.of(lines).trajectory().touches]
            assert kept == [point.label for point in record.points]
            assert training.phase in (Phase.PAUSED, Phase.COMPLETE)
            archive = TrialArchive(folder)
            archive.add_interrupted(path)
            assert not archive.problems
            assert archive.unacknowledged() == (record,)
            assert TrialArchive(folder).unacknowledged() == archive.unacknowledged()


def test_an_aborted_trial_is_shown_again_with_its_touches_though_its_disk_was_full_for_a_while(
    simulation, anywhere, tmp_path, monkeypatch
):
    with Server(simulation, tmp_path) as server:
        server.start()
        assert server.do(CommandName.CAPTURE).ok
        trial_id = server.start()
        for _ in range(2):
            server.move()
            assert server.do(CommandName.CAPTURE).ok
        with monkeypatch.context() as patch:
            patch.setattr(os, "write", on_full_disk)
            assert not server.do(CommandName.CAPTURE).ok
        assert server.do(CommandName.RESUME).ok
        server.move()
        assert server.do(CommandName.CAPTURE).data["label"] == "3"
        assert server.do(CommandName.ABORT).ok
    (path,) = tmp_path.glob(f"*{trial_id}{SUFFIX}")
    track = read_track(path)
    trial = RecordedTrial(track, anywhere)
    touches = [event for event in track.events if isinstance(event.entry, AcceptedTouch)]
    # The line of the refused touch is written once there is room, and does not count.
    assert [event.entry.kept for event in touches] == [1, 2, 3, 3]
    for event in touches:
        assert len(trial.state_at(event.time_s).training.touches) == event.entry.kept
    last = trial.state_at(trial.duration_s).training
    assert (last.phase, last.next_point, last.task) == (Phase.IDLE, None, "task-1")
    assert [touch.label for touch in last.touches] == ["1", "2", "3"]
