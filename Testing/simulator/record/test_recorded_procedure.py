"""A procedure in its journal: ended in any phase it continues there, and it replays bit by bit."""

import json
from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.journal.entries import MotionEnd
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.journal.recording import Recording, WholeRecording, read_track
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.motion.trial_motion import trial_motion
from rastrainer.protocol import PROCEDURE_PHASES, Phase
from rastrainer.study.journal_check import check_journal
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.core.interrupted_trial import find_interrupted
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.replay.recorded_trial import RecordedTrial
from rastrainer_simulator.replay.resimulation import replay
from rastrainer_simulator.state import OperatorInput
from rastrainer_simulator.trial_state import Tool
from Testing.simulator.record.test_interrupted_trial import Server, cut

IN = (0.0, 0.0, -1.0)


@pytest.fixture(scope="module")
def simulation(planned):
    return Simulation(planned, 3)


class Theater(Server):
    """A server on which a procedure is carried out with the sticks and by commands."""

    def must(self, command, **arguments):
        answer = self.do(command, **arguments)
        assert answer.ok, answer.message
        return answer.data

    def to_verifying(self, procedure="dbs"):
        self.do(CommandName.ABORT)
        start = {"task": "task-1", "trainee": "P01", "seed": 4, "procedure": procedure}
        self.must(CommandName.START_TASK, **start)
        for _ in range(15):
            self.must(CommandName.CAPTURE)
        self.must(CommandName.REGISTER)

    def use_exact_registration(self):
        matrix = transforms.inverse(self.loop.simulation.truth.head_to_world)
        numbers = {"freMm": 1.0, "expectedTreMm": 1.0, "matrix": matrix.ravel().tolist()}
        self.must(CommandName.USE_REGISTRATION, trialId=self.training.trial_id, **numbers)

    def feed(self, to_mm):
        """Feed by the stick, with other sticks in between, to a depth."""
        self.loop.hold_sticks(OperatorInput(IN, operator="gamepad"))
        self.until(lambda: MM_PER_M * self.loop.latest.feed >= to_mm)
        self.loop.hold_sticks(OperatorInput())
        self.move((0.0, 0.0, 0.0), 20)

    def align(self):
        """Have the robot align the guide."""
        ended = []
        unsubscribe = self.loop.subscribe(
            lambda result: ended.extend(e for e in result.events if isinstance(e.entry, MotionEnd))
        )
        self.must(CommandName.ALIGN_GUIDE, standOffMm=20.0)
        self.until(lambda: ended)
        unsubscribe()
        assert ended[-1].entry == MotionEnd("reached")
        assert self.loop.latest.alignment.is_exact

    def place(self, drilled_mm, placed_mm):
        """Go from aligning to the release."""
        self.align()
        self.must(CommandName.LOCK_GUIDE)
        self.feed(drilled_mm)
        self.must(CommandName.START_INSERTION)
        self.feed(placed_mm)
        self.must(CommandName.RELEASE_INSTRUMENT)

    def to(self, phase, procedure="dbs"):
        """Go to a phase of a procedure, and do something in it."""
        self.to_verifying(procedure)
        if phase is Phase.VERIFYING:
            return
        self.use_exact_registration()
        if procedure == "dbs":
            self.must(CommandName.CAPTURE)
        self.must(CommandName.ACCEPT_REGISTRATION)
        self.move((0.3, -0.2, 0.1), 40)
        if phase is Phase.ALIGNING:
            return
        self.align()
        self.must(CommandName.LOCK_GUIDE)
        self.feed(12.0)
        if phase is Phase.INSERTING:
            self.must(CommandName.START_INSERTION)
            self.feed(9.0)

    def finish(self, drilled_mm=14.0, placed_mm=11.0):
        """Continue from any phase to the end of the procedure."""
        if self.training.phase is Phase.VERIFYING:
            if self.training.procedure.registration is None:
                self.use_exact_registration()
            self.must(CommandName.ACCEPT_REGISTRATION)
        if self.training.phase is Phase.DRILLING:
            self.feed(drilled_mm)
            self.must(CommandName.START_INSERTION)
        if self.training.phase is Phase.INSERTING:
            self.feed(placed_mm)
            self.must(CommandName.RELEASE_INSTRUMENT)
        while self.training.phase is Phase.ALIGNING:
            self.place(drilled_mm, placed_mm)


@pytest.fixture(scope="module")
def finished(simulation, tmp_path_factory):
    """The journal of a whole procedure: registered again, realigned, paused."""
    folder = tmp_path_factory.mktemp("records")
    with Theater(simulation, folder) as server:
        server.to_verifying()
        server.use_exact_registration()
        server.must(CommandName.CAPTURE)
        server.move((0.5, 0.0, 0.0), 100)
        server.must(CommandName.REGISTER_AGAIN)
        for number in range(15):
            server.move((0.6, 0.0, 0.1) if number % 2 else (0.0, 0.6, -0.1), 10)
            server.must(CommandName.CAPTURE)
        server.must(CommandName.REGISTER)
        server.use_exact_registration()
        server.must(CommandName.ACCEPT_REGISTRATION)
        server.move((0.4, 0.2, 0.0), 50)
        server.align()
        server.must(CommandName.LOCK_GUIDE)
        server.feed(3.0)
        server.must(CommandName.RETRACT_DRILL)
        server.must(CommandName.PAUSE)
        server.must(CommandName.RESUME)
        server.finish(55.0, 60.0)
        (record,) = server.loop.archive.unacknowledged()
    return server.path, record


def test_a_whole_procedure_replays_to_the_last_bit(finished, planned):
    reading = read_journal(finished[0])
    assert reading.integrity is Integrity.INTACT
    report = replay(reading, planned)
    assert report.difference is None
    assert report.compared["feed"] >= 6
    assert report.compared["sample"] > 500


def sampled_depths(entries):
    """Return the last depth of each (trajectory, phase), the tool at rest after every feed."""
    depths, at = {}, None
    for entry in entries:
        if entry["kind"] == "phase" and "procedure" in entry:
            at = entry["procedure"]["trajectory"], entry["procedure"]["stage"]
        elif "feedMm" in entry and entry["kind"] == "sample":
            depths[at] = entry["feedMm"]
    return depths


def test_the_record_has_every_attempt_and_instrument(finished, planned):
    path, record = finished
    (registered,) = read_journal(path).of_kind("registered")
    written = registered["record"] | {"journalSha256": registered["sha256"]}
    delivered = record_from_json(TrialRecord, json.loads(json.dumps(record_to_json(record))))
    assert record_from_json(TrialRecord, written) == delivered
    truth = record_from_json(RevealedTruth, registered["truth"] | {"trueTreMm": 0.0})
    check_journal(delivered, truth, path.read_bytes(), planned.scenario)
    procedure = record.procedure
    first, accepted = procedure.attempts
    assert [len(first.checkpoints), len(accepted.checkpoints)] == [1, 0]
    assert [touch.label for touch in accepted.touches] == list(record.labels)
    left, right = procedure.instruments
    assert (left.alignments, right.alignments) == (2, 1)
    # How far the stick overshoots depends on the machine; the record has the last sample.
    sampled = sampled_depths(read_journal(path).entries)
    for number, instrument in enumerate(procedure.instruments):
        assert instrument.drill_depth_mm == sampled[number, "drilling"] >= 55.0
        assert instrument.instrument_depth_mm == sampled[number, "inserting"] >= 60.0
        assert instrument.self_aligned
    assert left.feed["drill_path_mm"] >= left.drill_depth_mm + 2.5
    assert left.feed["drill_reversals"] == 0
    assert left.feed["instrument_fastest_mm_s"] == pytest.approx(10.0)
    assert sum(procedure.phase_times_s.values()) == pytest.approx(procedure.duration_s)
    assert set(procedure.phase_times_s) == {"running", *(phase.value for phase in PROCEDURE_PHASES)}


def test_the_motion_of_a_trial_is_that_of_its_touches_alone(finished):
    path, record = finished
    lines = tuple(read_journal(path).lines())
    touching, whole = (kind.of(lines).trajectory() for kind in (Recording, WholeRecording))
    assert len(touching.touches) == len(whole.touches) == 15
    times = record.procedure.phase_times_s
    assert touching.times_s[-1] == pytest.approx(times["running"], abs=0.05)
    assert whole.times_s[-1] == pytest.approx(record.procedure.duration_s, abs=0.05)
    assert record.motion == pytest.approx(trial_motion(touching))
    assert record.motion["path_length_mm"] < 0.9 * trial_motion(whole)["path_length_mm"]


def test_the_procedure_is_replayed_in_the_views(finished, planned):
    path, record = finished
    trial = RecordedTrial(read_track(path), planned)
    times = np.arange(0.0, trial.duration_s, 0.1)
    states = [trial.state_at(float(time)) for time in times]
    assert {state.tool for state in states} == set(Tool)
    fed = [state for state in states if state.tool is Tool.ELECTRODE]
    deepest_mm = max(each.instrument_depth_mm for each in record.procedure.instruments)
    # A tenth of a second feeds 1 mm.
    assert MM_PER_M * max(state.feed for state in fed) == pytest.approx(deepest_mm, abs=1.0)
    assert {state.plan_in_world.name for state in fed} == {"Line 0", "Line 1"}
    for state in fed:
        assert state.alignment.is_exact
    assert all(state.feed == 0.0 for state in states if state.tool is Tool.GUIDE)
    done = trial.state_at(trial.duration_s).training.procedure
    for placed, instrument in zip(done.trajectories, record.procedure.instruments, strict=True):
        assert MM_PER_M * placed.instrument_depth == pytest.approx(instrument.instrument_depth_mm)
        assert placed.guide.direction == pytest.approx(instrument.guide_direction)


@pytest.mark.parametrize(
    ("phase", "procedure", "count"),
    [
        (Phase.VERIFYING, "dbs", 2),
        (Phase.ALIGNING, "dbs", 2),
        (Phase.DRILLING, "biopsy", 1),
        (Phase.INSERTING, "biopsy", 1),
    ],
)
def test_a_server_that_ends_in_a_phase_is_resumed_there_and_everything_replays(
    simulation, planned, tmp_path, phase, procedure, count
):
    with Theater(simulation, tmp_path) as server:
        server.to(phase, procedure)
        before = server.training.procedure
        server.loop.stop()
        size = server.path.read_bytes().rindex(b'{"n"')
        feed = server.loop.latest.feed
    cut(server.path, size)
    with Theater(simulation, tmp_path) as server:
        state = server.taken_up
        assert (state.training.phase, state.training.procedure.stage) == (Phase.PAUSED, phase)
        assert "everything is kept" in state.training.instruction
        assert state.feed == pytest.approx(feed, abs=1e-4)
        assert state.training.procedure.registration == before.registration
        assert [p.name for p in state.training.procedure.checkpoints] == [
            p.name for p in before.checkpoints
        ]
        # A journal's millimeters give meters back but for the last bit.
        resumed = state.training.procedure.trajectories
        for one, other in zip(resumed, before.trajectories, strict=True):
            assert replace(one, guide=None) == replace(other, guide=None)
            if other.guide is not None:
                assert one.guide.tip == pytest.approx(other.guide.tip, rel=1e-14)
                assert one.guide.direction == pytest.approx(other.guide.direction, rel=1e-14)
        server.must(CommandName.RESUME)
        assert server.training.phase is phase
        server.finish()
        (record,) = server.loop.archive.unacknowledged()
    reading = read_journal(server.path)
    assert reading.integrity is Integrity.INTACT
    assert replay(reading, planned).difference is None
    assert len(record.procedure.instruments) == count


def test_a_journal_of_another_procedure_is_neither_replayed_nor_resumed(finished, planned):
    track = read_track(finished[0])
    other = replace(track.header.procedure, sha256="0" * 64)
    track = replace(track, header=replace(track.header, procedure=other))
    with pytest.raises(InputError, match=r"^The trial was recorded with another procedure\.$"):
        RecordedTrial(track, planned)
    assert find_interrupted(finished[0].parent) is None
