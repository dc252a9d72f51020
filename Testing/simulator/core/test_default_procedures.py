"""The procedures of the default head, carried out by the simulated robot, against the truth."""

import numpy as np
import pytest

from rastrainer.commands import CommandName
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.procedure.plan import read_procedure_meshes
from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer.trial.procedure_outcome import (
    ProcedureMeasures,
    reference_duration_s,
    score_procedure,
)
from rastrainer_simulator.core.simulation import Simulation
from rastrainer_simulator.record.trial_records import FeedRecording, procedure_record
from Testing.simulator.core.test_procedure_simulation import IN, Surgeon

SEED = 11
SHIFT_MM = (0.6, -0.5, 0.4)
PAST_INNER_M = 0.0005


@pytest.fixture(scope="module")
def surgeon(anywhere):
    """A surgeon at the default head."""
    return Surgeon(Simulation(anywhere, SEED))


def place(surgeon, trajectory):
    """Align the guide by the robot, drill through the skull, and insert to the shown target."""
    assert surgeon.align() == "reached"
    surgeon.must(CommandName.LOCK_GUIDE)
    surgeon.feed(surgeon.through + PAST_INNER_M, IN)
    surgeon.must(CommandName.START_INSERTION)
    line, guide = surgeon.state.plan_in_world, surgeon.state.guide_axis
    depth = float(np.dot(np.subtract(line.target, guide.tip), guide.direction))
    assert depth == pytest.approx((trajectory.length_mm + 30.0) / MM_PER_M, abs=1e-4)
    surgeon.feed(depth, IN)
    surgeon.must(CommandName.RELEASE_INSTRUMENT)


@pytest.mark.parametrize(
    "name", ["dbs", *(pytest.param(name, marks=pytest.mark.soak) for name in ("biopsy", "seeg"))]
)
def test_a_default_procedure_can_be_carried_out_and_its_error_is_the_registrations(surgeon, name):
    scenario = surgeon.simulation.setup.scenario
    plan = scenario.procedure(name)
    surgeon.to(Phase.ALIGNING, name, SHIFT_MM)
    for trajectory in plan.trajectories:
        place(surgeon, trajectory)
    assert surgeon.state.training.phase is Phase.REGISTERED
    sha256 = plan.sha256(scenario.skull.file)
    record = procedure_record(surgeon.state.training.procedure, plan, sha256, FeedRecording())
    meshes = read_procedure_meshes(plan, scenario.skull.file)
    truth = surgeon.simulation.truth.head_to_world
    analysis = analyze_procedure(record, plan, meshes, truth)
    for errors in analysis.trajectories:
        assert errors.target_point_error.by_registration_mm == pytest.approx(
            np.linalg.norm(SHIFT_MM), abs=1e-6
        )
        assert errors.target_point_error.by_hand_mm < 0.1
        assert errors.angular_deviation_by_hand_deg < 0.05
        assert 0.0 < errors.plunge_mm < 1.0
        assert errors.self_aligned
    reference_s = reference_duration_s(130.0, plan)
    score = score_procedure(ProcedureMeasures.of(analysis, plan), reference_s)
    assert score.acceptable
    assert score.score > 75.0
