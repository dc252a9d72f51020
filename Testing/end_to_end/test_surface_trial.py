"""A trial by surface over OpenIGTLink: killed amid a stroke, resumed, registered on both sides."""

from __future__ import annotations

import time

import numpy as np
import pytest

from rastrainer.files.point_files import read_markups
from rastrainer.journal.journal_file import Integrity, read_journal
from rastrainer.json_records import record_from_json
from rastrainer.protocol import RegistrationMethod
from rastrainer.scenario.scenario import load_scenario
from rastrainer.sections.trial_logic import TrialLogic
from rastrainer.study.database.study import Study
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SCORE_VERSION
from rastrainer_simulator.export.trial_files import write_slicer_files
from rastrainer_simulator.record.trial_context import setup_of
from rastrainer_simulator.replay.resimulation import replay
from Testing.end_to_end.faulty_proxy import SlicerSide
from Testing.end_to_end.simulator_process import SimulatorProcess, ViewedSimulator
from Testing.end_to_end.test_trial_over_openigtlink import SPEED, Player
from Testing.end_to_end.tracing_trainee import TracingTrainee
from Testing.end_to_end.window_process import wait_until
from Testing.simulator.landmarked import LANDMARKS, OVER_THE_FACE, write_landmarked

pytestmark = pytest.mark.soak

SEED = 5
TIMEOUT_S = 120.0


@pytest.fixture(scope="module")
def seen(tmp_path_factory) -> dict:
    """Observations of a trial whose simulator is killed during the second stroke."""
    folder = tmp_path_factory.mktemp("surface")
    records, scenario_folder = folder / "records", write_landmarked(folder / "scenario")
    options = ("--scenario", str(scenario_folder), "--speed", SPEED)
    scenario = load_scenario(scenario_folder)
    seen = {"scenario": scenario, "records": records}
    with (
        SimulatorProcess(records, *options, "--no-views") as simulator,
        Player(simulator.port) as player,
    ):
        trainee = TracingTrainee(player, scenario, SEED)
        seen["trial"] = trainee.start("surface")
        trainee.trace(OVER_THE_FACE[0])
        trainee.trace(OVER_THE_FACE[1], ends=False)
        # Points are written within 0.2 s of simulated time.
        traced = trainee.state()["trace"]["kept"]
        wait_until(lambda: _written(records) >= traced, "the points of the stroke on the disk")
        simulator.kill()
    with ViewedSimulator(records, *options) as simulator:
        with Player(simulator.port) as player:
            trainee = TracingTrainee(player, scenario, SEED)
            seen["traced"], seen["paused"] = traced, trainee.state()
            player.do("Resume")
            trainee.lift_after(OVER_THE_FACE[1])
            for corners in OVER_THE_FACE[2:]:
                trainee.trace(corners)
            player.do("Register")
            seen["offer"] = player.next_offer()
        # No client is connected any longer: the simulator registers and scores the trial itself.
        (seen["journal"],) = records.glob("*.journal")
        wait_until(lambda: read_journal(seen["journal"]).of_kind("scored"), "its own score")
        reading = read_journal(seen["journal"])
        seen["own"] = {
            kind: reading.of_kind(kind)[0]["arguments"] for kind in ("registration", "scored")
        }
        seen["slicer"] = _stored_by_slicer(simulator.port, scenario, records, folder)
    return seen


def _written(records) -> int:
    (path,) = records.glob("*.journal")
    return len(read_journal(path).of_kind("trace"))


def _stored_by_slicer(port, scenario, records, folder) -> dict:
    """Have Slicer's side store the trial, register it and score it."""
    find = lambda _name: scenario  # noqa: E731
    slicer = SlicerSide(folder / "study.db", port, TrialLogic, find, records)
    scored, problems = [], []
    slicer.logic.trialScored.connect(scored.append)
    slicer.logic.problemFound.connect(problems.append)
    give_up = time.monotonic() + TIMEOUT_S
    while not scored and time.monotonic() < give_up:
        slicer.run_for(10)
    slicer.close()
    assert problems == []
    return {"analysis": scored[0], "study": folder / "study.db"}


def test_every_traced_point_survives_a_kill_in_the_middle_of_a_stroke(seen):
    assert seen["paused"]["phase"] == "paused"
    assert seen["paused"]["trace"]["kept"] >= seen["traced"] > 100
    assert seen["paused"]["trace"]["strokes"] == 2
    assert not seen["paused"]["trace"]["on"]


def test_the_record_has_the_landmarks_the_trace_and_little_unintended_contact(seen):
    record = record_from_json(TrialRecord, seen["offer"])
    assert record.method is RegistrationMethod.SURFACE
    assert record.labels == tuple(landmark.name for landmark in LANDMARKS[:3])
    assert 150 < len(record.trace) <= 500
    steps = np.linalg.norm(np.diff(record.trace_mm, axis=0), axis=1)
    assert steps.min() >= 1.0 - 1e-9
    assert np.median(steps) < 1.5
    unintended_s = record.motion["unintended_contact_time_s"]
    assert unintended_s < 0.2 * record.motion["contact_time_s"]
    assert record.completion_time_s > record.trace[-1][3] - record.trace[0][3]


def test_the_trial_replays_to_the_last_bit_through_its_interruption(seen):
    reading = read_journal(seen["journal"])
    assert reading.integrity is Integrity.INTACT
    report = replay(reading, setup_of(reading.header, seen["scenario"].folder))
    assert report.difference is None
    assert report.compared["continued"] == 1
    assert report.compared["trace"] == len(reading.of_kind("trace"))


def test_the_simulator_and_slicer_register_and_score_it_identically_to_the_last_digit(seen):
    own, analysis = seen["own"], seen["slicer"]["analysis"]
    assert own["registration"]["matrix"] == analysis.rigid.matrix.ravel().tolist()
    assert own["registration"]["freMm"] == analysis.rigid.fre_mm < 0.5
    assert own["scored"]["score"] == analysis.score.score
    assert analysis.score.version == own["scored"]["details"]["scoreVersion"] == SCORE_VERSION
    assert analysis.score.is_accurate
    assert analysis.truth.true_tre_mm < 1.0
    assert analysis.score.measures.common_bias_mm is None


def test_slicer_stores_the_trace_and_exports_it(seen, tmp_path):
    with Study.open(seen["slicer"]["study"]) as study:
        stored = study.trial(seen["trial"])
    assert stored.record == record_from_json(TrialRecord, seen["offer"])
    names = [path.name for path in write_slicer_files(stored, tmp_path)]
    assert {"traced-world.mrk.json", "traced-ras.mrk.json"} <= set(names)
    written = read_markups(tmp_path / "traced-world.mrk.json").points
    np.testing.assert_allclose(written, stored.record.trace_mm, atol=1e-9)
