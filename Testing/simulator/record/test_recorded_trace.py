"""A trace survives the simulator's end, goes with its trial, and is played again exactly."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.journal.journal_file import SEED_SUFFIX, Integrity, read_journal
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import MIN_TRACE_POINTS, Phase, RegistrationMethod
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.record.trial_archive import interrupted_attempt
from rastrainer_simulator.replay.resimulation import replay
from Testing.domain.trial.trial_records import make_traced
from Testing.simulator.landmarked import LANDMARKS, with_landmarks
from Testing.simulator.record.test_interrupted_trial import Server, cut


@pytest.fixture(scope="module")
def airy(anywhere):
    """Return a setup with landmarks, in which everything counts, also a trace through the air."""
    training = replace(anywhere.settings.training, landmark_radius=10.0, skin_tolerance=10.0)
    return replace(
        anywhere,
        scenario=with_landmarks(anywhere.scenario),
        settings=replace(anywhere.settings, training=training),
        landmarks_sha256="of these",
    )


@pytest.fixture(scope="module")
def traced_in_air(airy):
    return Simulation(airy, 3)


def start(server, method="surface"):
    server.do(CommandName.ABORT)
    answer = server.do(CommandName.START_TASK, task="task-1", trainee="P01", method=method)
    assert answer.ok, answer.message
    while server.training.next_point is not None:
        assert server.do(CommandName.CAPTURE).ok


def stroke(server, ticks, translation=(0.9, -0.3, 0.2), ends=True):
    assert server.do(CommandName.TRACE, on=True).ok
    server.move(translation, ticks)
    if ends:
        assert server.do(CommandName.TRACE, on=False).ok


def positions(entries):
    return [tuple(entry["positionMm"]) for entry in entries]


def test_a_stroke_cut_off_by_a_kill_keeps_its_written_points_and_the_trial_replays_bit_for_bit(
    traced_in_air, airy, tmp_path
):
    with Server(traced_in_air, tmp_path) as server:
        start(server)
        stroke(server, 60)
        assert server.do(CommandName.UNDO).ok
        stroke(server, 60, (-0.9, 0.1, 0.0))
        stroke(server, 150, ends=False)
        server.loop.stop()
        size = server.path.read_bytes().rindex(b'{"n"', 0, -200)
    cut(server.path, size)
    written = positions(read_journal(server.path).of_kind("trace"))

    with Server(traced_in_air, tmp_path) as server:
        training = server.taken_up.training
        assert training.phase is Phase.PAUSED
        assert not training.trace.is_on
        assert "traced points are kept" in training.instruction
        assert len(training.trace.strokes) == 2
        kept = len(training.trace.points)
        assert kept > training.trace.strokes[-1] > 0
        assert server.do(CommandName.RESUME).ok
        while len(server.training.trace.points) < MIN_TRACE_POINTS:
            stroke(server, 60, (0.2, 0.9, 0.1))
        assert server.training.phase is Phase.COMPLETE
        assert server.do(CommandName.REGISTER).ok
        (record,) = server.loop.archive.unacknowledged()
    reading = read_journal(server.path)
    assert reading.integrity is Integrity.INTACT
    report = replay(reading, airy)
    assert report.difference is None
    assert report.compared["trace"] == len(reading.of_kind("trace"))
    assert record.method is RegistrationMethod.SURFACE
    assert [point[:3] for point in record.trace[:kept]] == written[-kept:]
    assert record.completion_time_s < record.trace[-1][3]
    assert record_from_json(TrialRecord, record_to_json(record)) == record
    assert [point.label for point in record.points] == [each.name for each in LANDMARKS[:3]]


def test_a_trial_with_landmarks_other_than_the_scenarios_is_not_replayed(airy):
    own = airy.recorded(method=RegistrationMethod.SURFACE)
    assert airy.difference(SimpleNamespace(**own)) == ""
    others = {**own, "method": replace(own["method"], landmarks_sha256="of others")}
    assert airy.difference(SimpleNamespace(**others)) == "landmarks"


def test_a_record_that_does_not_fit_its_method_is_refused_with_a_message():
    for changes, said in (
        ({"trace": [[1.0, 2.0, 3.0, 2.0]] * 501}, "at most 500 points"),
        ({"trace": [[1, 2, 3, 4]] * 29}, "needs at least 30"),
        ({"trace": [[1, 2, 9e9, 4]] * 30}, "x, y, z, simTimeS"),
        ({"trace": [[1, 2, 3, 4 - n / 50] for n in range(30)]}, "time"),
        ({"method": "landmarks"}, "must hold no trace"),
        ({"points": []}, "0 touched landmarks"),
    ):
        with pytest.raises(InputError, match=said):
            record_from_json(TrialRecord, make_traced(**changes))


def test_aborted_and_interrupted_trials_report_their_method_and_how_much_was_traced(
    traced_in_air, tmp_path
):
    with Server(traced_in_air, tmp_path) as server:
        start(server)
        stroke(server, 60)
        stroke(server, 60, (0.0, 0.9, 0.1))
        assert server.do(CommandName.UNDO).ok
        traced = len(server.training.trace.points)
        assert traced > 0
        assert server.do(CommandName.ABORT, reason="trainee").ok
        server.write()
        (record,) = server.loop.archive.unacknowledged()
    assert (record.method, record.traced) == (RegistrationMethod.SURFACE, traced)
    data, seed = server.path.read_bytes(), read_journal(server.path).header.seed
    server.path.with_suffix(SEED_SUFFIX).write_text(str(seed))
    server.path.write_bytes(data[: data.index(b'"kind":"aborted"')])
    interrupted = interrupted_attempt(read_journal(server.path))
    assert (interrupted.method, interrupted.traced) == (RegistrationMethod.SURFACE, traced)
