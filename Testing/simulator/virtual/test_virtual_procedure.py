"""Virtual trainees carry out procedures: errors split as known, and a study that recovers it."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.procedure.plan import read_procedure_meshes
from rastrainer.procedure.record import ProcedureRecord, UsedRegistration
from rastrainer.scenario.scenario import load_scenario
from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.assets import asset_path
from rastrainer_simulator.report.procedures import procedures
from rastrainer_simulator.virtual.cohort import simulate_cohort
from rastrainer_simulator.virtual.play import PlaySettings
from rastrainer_simulator.virtual.virtual_procedure import ProcedureHands, VirtualProcedure

SCENARIO = load_scenario(asset_path("scenarios", "colin27"))
SEEG = SCENARIO.procedure("seeg")
TRUTH = SCENARIO.perturbed_head_to_world(3)
OFF = transforms.rigid(np.eye(3), np.array([1.0, 0.0, 0.0]))


@pytest.fixture(scope="module")
def meshes():
    return read_procedure_meshes(SEEG, SCENARIO.skull.file)


def analyzed(meshes, hands, seed=1):
    """Errors of SEEG by a registration that moves the plan by 1 mm."""
    matrix = transforms.inverse(TRUTH @ OFF)
    used = UsedRegistration(tuple(float(value) for value in matrix.ravel()), 0.5, 0.4)
    random = np.random.default_rng(seed)
    done = VirtualProcedure(
        SEEG, meshes.skull, "0" * 64, TRUTH, used, 100.0, hands, random
    ).carried_out()
    assert record_from_json(ProcedureRecord, record_to_json(done)) == done
    return done, analyze_procedure(done, SEEG, meshes, TRUTH)


def test_steady_hands_leave_only_the_registration_error(meshes):
    hands = ProcedureHands(0.0, 0.0, 0.0, 0.0, 0.0)
    done, analysis = analyzed(meshes, hands)
    for errors in analysis.trajectories:
        assert errors.target_point_error.by_registration_mm == pytest.approx(1.0, abs=1e-6)
        assert errors.target_point_error.by_hand_mm == pytest.approx(0.0, abs=1e-6)
        assert errors.plunge_mm == pytest.approx(0.0, abs=1e-6)
    (attempt,) = done.attempts
    assert [check.error_mm for check in attempt.checkpoints] == pytest.approx([1.0] * 3, abs=1e-6)


def test_a_cohort_whose_protocol_has_a_procedure_is_reported_with_the_split(
    protocol, population, tmp_path
):
    asked = replace(protocol, modes=("desktop",), procedures={"task-1": "dbs"})
    settings = PlaySettings()
    with pytest.raises(InputError, match="contain only the touches"):
        simulate_cohort(asked, population, 1, 7, tmp_path / "x", settings, with_journals=True)
    run = simulate_cohort(asked, population, 1, 7, tmp_path / "study", settings, workers=1)
    assert (run.played, run.stuck) == (1, 0)
    data = read_study_data(tmp_path / "study" / "study.db")
    (trial,) = data.trials
    assert trial.procedure.analysis.procedure == "dbs"
    assert trial.values["procedure_target_rms_mm"] > 0.0
    assert trial.values["procedure_score"] == trial.procedure.score.score
    assert "1 of 1 trial continued with a procedure: 2 lines in all" in procedures(data)
