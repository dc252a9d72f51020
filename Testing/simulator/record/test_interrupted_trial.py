"""A trial whose server has ended is resumed where it was, and continued in the same journal."""

import errno
import os

import numpy as np
import pytest

from rastrainer.commands import CommandName, check_arguments
from rastrainer.errors import InputError
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.journal.recording import Recording
from rastrainer.protocol import Phase, Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.interrupted_trial import find_interrupted
from rastrainer_simulator.loop.control_loop import ControlLoop
from rastrainer_simulator.record.trial_archive import SUFFIX
from rastrainer_simulator.replay.resimulation import replay
from rastrainer_simulator.state import OperatorInput
from Testing.simulator.lock_step import LockStep


class Server:
    """A control loop over a folder, as a server runs it; `end` is its end in the middle."""

    def __init__(self, simulation, folder):
        found = find_interrupted(folder)
        reading = None
        if found is not None:
            reading, interrupted = found
            simulation.resume_trial(interrupted)
        self._take(ControlLoop(simulation, folder, speed=None, interrupted=reading), folder)

    def _take(self, loop, folder):
        self.loop, self.folder, self.taken_up = loop, folder, loop.latest
        lock_step = LockStep(loop)
        self.tick, self.until, self.write = lock_step.tick, lock_step.until, lock_step.write

    def __enter__(self):
        self.loop.thread.start()
        return self

    def __exit__(self, *_exception):
        self.loop.stop()

    @property
    def training(self):
        return self.loop.latest.training

    @property
    def path(self):
        (path,) = self.folder.glob(f"*{SUFFIX}")
        return path

    def do(self, command, **arguments):
        return self.answers(
            self.loop.submit(command, check_arguments(command, arguments), "tester")
        )

    def answers(self, answer):
        """Tick until a command is answered; return the answer."""
        while not answer.done():
            self.tick()
            self.write()
        return answer.result()

    def start(self):
        self.do(CommandName.ABORT)
        return self.do(CommandName.START_TASK, task="task-1", trainee="P01").data["trialId"]

    def move(self, translation=(0.4, -0.3, 0.2), ticks=20):
        """Hold the sticks for a number of ticks."""
        self.loop.hold_sticks(OperatorInput(translation, operator="gamepad"))
        self.tick(ticks)
        self.loop.hold_sticks(OperatorInput())
        self.tick()

    def finish(self):
        while self.training.phase is not Phase.COMPLETE:
            assert self.do(CommandName.CAPTURE).ok
        assert self.do(CommandName.REGISTER).ok


def on_full_disk(*_arguments):
    """Stand in for `os.write`."""
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


def cut(path, size):
    """Make of a journal what a kill leaves behind."""
    with path.open("r+b") as file:
        file.truncate(size)


def test_the_trial_continues_at_the_next_fiducial_and_its_single_journal_replays_bit_for_bit(
    simulation, anywhere, tmp_path
):
    with Server(simulation, tmp_path) as server:
        trial_id = server.start()
        server.do(CommandName.SET_CAMERA, camera="far")
        for _ in range(4):
            server.move()
            assert server.do(CommandName.CAPTURE).ok
        assert server.do(CommandName.UNDO).ok
        server.move((-0.5, 0.1, 0.3), 60)
        touches = server.training.touches
        server.loop.stop()
        size = server.path.read_bytes().rindex(b'{"n"')
    cut(server.path, size)
    last_sample = read_journal(server.path).of_kind("sample")[-1]

    with Server(simulation, tmp_path) as server:
        assert server.taken_up.training.trial_id == trial_id
        assert server.taken_up.training.phase is Phase.PAUSED
        assert server.taken_up.training.next_point == "4"
        assert server.taken_up.q == tuple(last_sample["q"])
        assert server.taken_up.camera == "far"
        np.testing.assert_allclose(
            [t.position for t in server.taken_up.training.touches],
            [t.position for t in touches],
            rtol=1e-15,  # The journal has them in mm.
        )
        assert "3 of 15 points are kept" in server.training.instruction
        assert server.do(CommandName.RESUME).ok
        server.move()
        assert server.do(CommandName.CAPTURE).data["label"] == "4"
        server.finish()
        (record,) = server.loop.archive.unacknowledged()
    reading = read_journal(server.path)
    assert reading.integrity is Integrity.INTACT
    report = replay(reading, anywhere)
    assert report.difference is None
    assert report.compared["continued"] == 1
    assert record.trial_id == trial_id
    assert record.undone_touches == 1
    assert [point.position_mm for point in record.points[:3]] == [
        tuple(entry["positionMm"]) for entry in reading.of_kind("touch")[:3]
    ]


def test_a_trial_interrupted_repeatedly_continues_and_waits_for_its_registration_once_complete(
    simulation, anywhere, tmp_path
):
    with Server(simulation, tmp_path) as server:
        server.start()
    for _ in range(3):
        with Server(simulation, tmp_path) as server:
            assert server.do(CommandName.RESUME).ok
            server.move()
            for _ in range(5):
                assert server.do(CommandName.CAPTURE).ok
    with Server(simulation, tmp_path) as server:
        assert server.training.phase is Phase.COMPLETE
        assert "all 15 points are kept" in server.training.instruction
        assert server.do(CommandName.REGISTER).ok
    reading = read_journal(server.path)
    assert reading.integrity is Integrity.INTACT
    assert replay(reading, anywhere).difference is None


def test_the_trials_clock_is_stopped_until_it_is_resumed(simulation, tmp_path):
    with Server(simulation, tmp_path) as server:
        server.start()
        assert server.do(CommandName.CAPTURE).ok
        server.move(ticks=100)
    last = max(entry["simTimeS"] for entry in read_journal(server.path).entries)
    with Server(simulation, tmp_path) as server:
        elapsed = server.taken_up.elapsed
        server.move(ticks=500)
        assert server.loop.latest.elapsed == elapsed
        assert server.do(CommandName.RESUME).ok
        server.finish()
        (record,) = server.loop.archive.unacknowledged()
        at_end = server.loop.latest.sim_time
    started = read_journal(server.path).header.before.sim_time_s
    assert elapsed == pytest.approx(last - started, abs=1e-6)
    assert elapsed <= record.completion_time_s < at_end - started - 500 * 0.004
    times = Recording.of(read_journal(server.path).lines()).trajectory().times_s
    assert np.all(np.diff(times) > 0.0)


def test_a_trial_interrupted_while_pressing_continues_unpressed_and_replays(
    simulation, anywhere, tmp_path
):
    with Server(simulation, tmp_path) as server:
        server.start()
        while server.loop.latest.depth < 0.002:
            server.move((0.0, 0.0, -0.6), 10)
        # Until a sample shows what the stick has pressed before it was released.
        server.move((0.0, 0.0, 0.0), 20)
        pressed_mm = MM_PER_M * server.loop.latest.depth
    with Server(simulation, tmp_path) as server:
        assert server.taken_up.proximity is Proximity.CONTACT
        assert server.taken_up.depth == 0.0
        assert server.do(CommandName.RESUME).ok
        server.move((0.0, 0.0, 0.6), 60)
        server.finish()
        (record,) = server.loop.archive.unacknowledged()
    reading = read_journal(server.path)
    assert replay(reading, anywhere).difference is None
    contacts = Recording.of(reading.lines()).trajectory().contacts
    assert max(contact.greatest_depth_mm for contact in contacts) >= pressed_mm
    assert record.motion["pressing_depth_mm"] >= (1 - 1e-9) * pressed_mm / np.sqrt(15)


def test_a_waiting_trial_leaves_its_journal_unchanged(simulation, tmp_path):
    with Server(simulation, tmp_path) as server:
        server.start()
        server.do(CommandName.CAPTURE)
    before = server.path.read_bytes()
    for _ in range(3):
        with Server(simulation, tmp_path) as server:
            assert server.training.phase is Phase.PAUSED
            server.do(CommandName.SET_CAMERA, camera="far")
            server.move(ticks=120)
    assert server.path.read_bytes() == before


def test_an_altered_journal_is_named_and_not_resumed(simulation, tmp_path):
    with Server(simulation, tmp_path) as server:
        server.start()
        server.do(CommandName.CAPTURE)
    path = server.path
    path.write_bytes(path.read_bytes().replace(b'"P01"', b'"P02"', 1))
    with pytest.raises(InputError, match=r"altered: line 1 .* cannot be continued"):
        find_interrupted(tmp_path)
