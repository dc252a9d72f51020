"""A trial on shifted skin: its points are measured with the skin, and that survives everything."""

import numpy as np
import pytest

from rastrainer.commands import CommandName, check_arguments
from rastrainer.errors import InputError
from rastrainer.head.mesh import read_head_mesh
from rastrainer.head.trial_head import SkinShift
from rastrainer.journal.journal_file import read_journal
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.protocol import Phase
from rastrainer.study.journal_check import check_journal
from rastrainer.trial.analysis import RevealedTruth
from rastrainer.trial.record import TrialRecord
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.net.views.outgoing import TraceUpdate
from rastrainer_simulator.presentation.presenter import TraceGuidance
from rastrainer_simulator.record.trial_archive import archived_trial
from rastrainer_simulator.replay.resimulation import replay
from Testing.simulator.record.test_interrupted_trial import Server
from Testing.simulator.record.test_recorded_trace import airy, stroke  # noqa: F401

SKIN = {"shiftMm": 3.0, "indentationMm": 0.5}
SEED = 11
REGISTRATION = {"matrix": np.eye(4).ravel().tolist(), "freMm": 1.0, "expectedTreMm": 1.0}


@pytest.fixture(scope="module")
def simulation(airy):  # noqa: F811
    return Simulation(airy, 3)


def start(server, **others):
    server.do(CommandName.ABORT)
    begin = {"task": "task-1", "trainee": "P01", "method": "surface", "seed": SEED}
    answer = server.do(CommandName.START_TASK, **begin, **others)
    assert answer.ok, answer.message
    while server.training.next_point is not None:
        assert server.do(CommandName.CAPTURE).ok


def measured(simulation, tips_mm):
    """Return where tips (n, 3), World, mm, are measured in the trial of the seed."""
    mesh, truth = read_head_mesh(simulation.setup.scenario.head), simulation.truth
    assert truth.skin == SkinShift(3.0, SEED, 0.5)
    in_head = np.array([truth.in_head(tip) for tip in np.array(tips_mm)])
    return truth.in_world(truth.skin.measured(in_head, mesh))


def test_points_on_shifted_skin_stay_hidden_and_survive_a_kill_and_a_replay(simulation, tmp_path):
    with Server(simulation, tmp_path) as server:
        start(server, skin=SKIN)
        stroke(server, 40)
        server.loop.stop()
        latest = server.loop.latest
        before = latest.training
    tips = [entry["positionMm"] for entry in read_journal(server.path).of_kind("trace")]
    places = measured(simulation, tips)
    assert np.linalg.norm(places[0] - tips[0]) > 0.5
    found = 1000.0 * np.array([point.position for point in before.trace.points])
    np.testing.assert_allclose(found, places, atol=1e-9)
    shown = TraceUpdate().news(latest, TraceGuidance(), 0.0).points
    pose = latest.head_to_world
    in_head = (tips - 1000.0 * pose[:3, 3]) @ pose[:3, :3]
    np.testing.assert_allclose(shown, in_head, atol=0.011)
    # The path is measured in millimeters from point to point.
    assert np.linalg.norm(np.diff(tips, axis=0), axis=1).min() >= 1.0 - 1e-9

    with Server(simulation, tmp_path) as server:
        after = server.taken_up.training
        assert [t.position for t in after.touches] == [t.position for t in before.touches]
        again = [1000.0 * np.array(point.position) for point in after.trace.points]
        np.testing.assert_allclose(again, found, atol=1e-9)
        if after.phase is Phase.PAUSED:
            assert server.do(CommandName.RESUME).ok
        while server.training.phase is not Phase.COMPLETE:
            stroke(server, 60, (0.2, 0.9, 0.1))
        assert server.do(CommandName.REGISTER).ok
        (record,) = server.loop.archive.unacknowledged()
        revealed = server.do(
            CommandName.SUBMIT_REGISTRATION, trialId=record.trial_id, **REGISTRATION
        )
    assert record.skin == SkinShift(3.0, 0, 0.5)
    assert record_to_json(record)["skin"] == SKIN
    assert record_from_json(TrialRecord, record_to_json(record)) == record
    np.testing.assert_allclose(record.trace_mm[: len(places)], places, atol=1e-9)
    assert revealed.data["skin"] == {**SKIN, "seed": SEED}
    reading = read_journal(server.path)
    assert replay(reading, simulation.setup).difference is None
    truth, journal = record_from_json(RevealedTruth, revealed.data), server.path.read_bytes()
    check_journal(record, truth, journal, simulation.setup.scenario)
    assert archived_trial(reading).truth.skin == SkinShift(3.0, SEED, 0.5)


def test_an_impossible_skin_shift_is_refused_with_a_message():
    for skin in ({"shiftMm": float("nan")}, {"indentationMm": 21}, {"shift": 1}, 2.0):
        begin = {"task": "task-1", "trainee": "P01", "skin": skin}
        with pytest.raises(InputError, match="each a number from 0 to 20 mm"):
            check_arguments(CommandName.START_TASK, begin)
