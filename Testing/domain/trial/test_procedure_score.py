"""A procedure is analyzed and scored, and its score has the documented properties."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rastrainer import transforms
from rastrainer.commands import CommandName, check_arguments
from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.procedure.errors import analyze_procedure
from rastrainer.procedure.plan import MAX_SAFETY_MM
from rastrainer.registration.registration import register
from rastrainer.scenario.scenario import load_scenario
from rastrainer.trial import procedure_outcome as scoring
from rastrainer.trial.analysis import RevealedTruth, analyze_trial, score_arguments
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer_simulator.assets import asset_path
from Testing.domain.procedure.made_up_procedure import made_up_meshes, made_up_procedure, trajectory
from Testing.domain.procedure.procedure_records import recorded
from Testing.domain.trial.trial_records import make_record

references = st.sampled_from([120.0, 300.0, 900.0])
LIMITS = {
    "worst_target_mm": scoring.TARGET_LIMIT_MM,
    "worst_entry_mm": scoring.ENTRY_LIMIT_MM,
    "worst_angle_deg": scoring.ANGLE_LIMIT_DEG,
    "plunge_mm": scoring.PLUNGE_LIMIT_MM,
    "hits": 0,
    "missed_bone": 0,
}
SCORED = ("duration_s", "target_mm", "entry_mm", "angle_deg", "plunge_mm", "intrusion_mm")
MESHES, DOWN = made_up_meshes(), trajectory()


def procedures(target=1000.0, entry=1000.0, angle=180.0, plunge=200.0, counts=3):
    """Any procedure within limits."""
    limits = (target, target, entry, entry, angle, angle, plunge, MAX_SAFETY_MM)
    lengths = (st.floats(0.0, limit) for limit in limits)
    numbers = (st.integers(0, counts) for _ in range(2))
    return st.builds(scoring.ProcedureMeasures, st.floats(1.0, 86_400.0), *lengths, *numbers)


acceptable = procedures(
    scoring.TARGET_LIMIT_MM,
    scoring.ENTRY_LIMIT_MM,
    scoring.ANGLE_LIMIT_DEG,
    scoring.PLUNGE_LIMIT_MM,
    counts=0,
)


def score(measures, reference):
    return scoring.score_procedure(measures, reference).score


@settings(max_examples=40)
@given(st.sampled_from(SCORED), procedures(), st.floats(1e-3, 1e3), references)
def test_faster_more_accurate_and_gentler_are_each_strictly_better(
    measure, measures, step, reference
):
    worse = replace(measures, **{measure: getattr(measures, measure) + step})
    assert score(measures, reference) > score(worse, reference)


@settings(max_examples=40)
@given(st.sampled_from([*LIMITS]), procedures(), acceptable, st.floats(0.0, 100.0), references)
def test_exceeding_a_limit_cannot_be_compensated(measure, measures, other, excess, reference):
    limit = LIMITS[measure]
    beyond = 1 + int(excess) if limit == 0 else math.nextafter(limit, math.inf) + excess
    worse = scoring.score_procedure(replace(measures, **{measure: beyond}), reference)
    assert not worse.acceptable
    best = scoring.score_procedure(other, reference)
    assert best.acceptable
    assert worse.score < best.score


PERFECT = scoring.ProcedureMeasures(100.0, *([0.0] * 8), 0, 0)


def test_scores_of_version_1_do_not_change():
    assert scoring.PROCEDURE_SCORE_VERSION == "procedure-1"
    usual = replace(
        PERFECT,
        target_mm=2.0,
        worst_target_mm=2.0,
        entry_mm=1.5,
        worst_entry_mm=1.5,
        angle_deg=2.0,
        worst_angle_deg=2.0,
        plunge_mm=2.0,
        intrusion_mm=1.5,
    )
    assert score(usual, 100.0) == pytest.approx(100 * (0.52 * 0.5**5) ** (1 / 6))
    assert score(PERFECT, 100.0) == pytest.approx(100 * 0.52 ** (1 / 6))
    worst = 0.04 / (1 + 2.25) / 5 / 7.25 / 7.25 / (1 + (MAX_SAFETY_MM / 1.5) ** 2)
    hit = replace(PERFECT, intrusion_mm=1.5, hits=1)
    assert score(hit, 100.0) == pytest.approx(100 * (0.52 * 0.5 * worst) ** (1 / 6))


def measured(record, procedure):
    analysis = analyze_procedure(record, procedure, MESHES, np.eye(4))
    return scoring.ProcedureMeasures.of(analysis, procedure)


def carried_out(off, lines=(DOWN,), **changes):
    """The score of steady hands whose registration is off by a shift (3,), mm."""
    procedure = made_up_procedure(*lines)
    record = recorded(
        procedure, transforms.rigid(np.eye(3), np.array(off, dtype=float)), drill=14.5
    )
    record = replace(record, **changes)
    return scoring.score_procedure(
        measured(record, procedure), scoring.reference_duration_s(130.0, procedure)
    )


def test_a_hit_is_never_acceptable_however_fast_and_accurate():
    through = trajectory(entry=(30, 0, 84.85), target=(30, 0, -20))
    found = carried_out((0.0, 0.0, 0.0), lines=(through,), duration_s=1.0)
    assert found.measures.hits == 1
    assert found.measures.worst_target_mm == pytest.approx(0.0, abs=1e-9)
    assert not found.acceptable
    slow_and_poor = carried_out((2.9, 0.0, 0.0), duration_s=86_400.0)
    assert slow_and_poor.acceptable
    assert found.score < slow_and_poor.score


def test_the_worst_of_several_instruments_decides_whether_it_is_acceptable():
    lines = [trajectory(f"{n}", (n, 0, 89.9), (n, 0, 20)) for n in range(0, -20, -4)]
    procedure = made_up_procedure(*lines)
    record = recorded(procedure, np.eye(4), drill=14.5)
    first, *others = record.instruments
    deeper = replace(first, instrument_depth_mm=first.instrument_depth_mm + 3.5)
    record = replace(record, instruments=(deeper, *others))
    measures = measured(record, procedure)
    assert measures.target_mm < scoring.TARGET_LIMIT_MM < measures.worst_target_mm
    assert not scoring.score_procedure(measures, 600.0).acceptable


def test_what_a_trainee_sees_plays_no_part_in_the_score():
    """Checkpoints, FRE and the number of attempts change nothing."""
    procedure = made_up_procedure()
    record = recorded(procedure, np.eye(4))
    accepted = record.attempts[-1]
    seen = replace(
        accepted,
        registration=replace(accepted.registration, fre_mm=9.0, expected_tre_mm=9.0),
        checkpoints=(),
    )
    scores = {
        score(measured(each, procedure), 300.0)
        for each in (record, replace(record, attempts=(seen,)))
    }
    assert len(scores) == 1


SCENARIO = load_scenario(asset_path("scenarios", "colin27"))
TRUTH = SCENARIO.perturbed_head_to_world(7)
REVEALED = RevealedTruth(tuple(TRUTH.ravel().tolist()), 0.4)
MOTION = dict.fromkeys(SAFETY_METRICS, 0.0)


@pytest.fixture(scope="module")
def record():
    """Task 1 touched with an error of 1 mm, and SEEG carried out as it was shown."""
    random, task = np.random.default_rng(9), SCENARIO.task("task-1")
    touches = transforms.apply(TRUTH, task.fiducials)
    touches += random.normal(0.0, 1.0 / np.sqrt(3), touches.shape)
    shown = transforms.inverse(register(touches, task.fiducials).matrix)
    procedure = SCENARIO.procedure("seeg")
    done = replace(
        recorded(procedure, shown, drill=16.0), sha256=procedure.sha256(SCENARIO.skull.file)
    )
    points = [
        {**point, "positionMm": position.tolist()}
        for point, position in zip(make_record()["points"], touches, strict=True)
    ]
    value = {**make_record(points=points), "motion": MOTION, "procedure": record_to_json(done)}
    return record_from_json(TrialRecord, json.loads(json.dumps(value)))


def test_a_procedure_is_analyzed_and_scored_once_the_truth_is_known(record):
    before = analyze_trial(record, SCENARIO)
    assert before.procedure is None
    found = analyze_trial(record, SCENARIO).scored(SCENARIO, REVEALED).procedure
    assert len(found.analysis.trajectories) == 5
    assert 0.0 < found.analysis.target_point_error_rms_mm < 1.5
    assert found.analysis.target_point_error_by_hand_rms_mm == pytest.approx(0.0, abs=1e-9)
    assert found.score.is_accurate
    assert found.score.reference_s > 400.0


def test_a_guide_that_the_robot_aligned_leaves_less_time_and_is_named_in_the_feedback(record):
    by_hand = analyze_trial(record, SCENARIO).scored(SCENARIO, REVEALED).procedure
    first, *others = record.procedure.instruments
    instruments = (replace(first, self_aligned=True), *others)
    changed = replace(record, procedure=replace(record.procedure, instruments=instruments))
    by_robot = analyze_trial(changed, SCENARIO).scored(SCENARIO, REVEALED).procedure
    assert by_robot.score.reference_s == by_hand.score.reference_s - 30.0
    assert by_robot.score.score < by_hand.score.score
    told = [each["selfAligned"] for each in by_robot.summary()["trajectories"]]
    assert told == [True, *[False] * 4]


def test_the_outcome_of_a_procedure_is_submitted_with_the_score(record):
    analysis = analyze_trial(record, SCENARIO).scored(SCENARIO, REVEALED)
    arguments = json.loads(json.dumps(score_arguments(analysis)))
    check_arguments(CommandName.TRIAL_SCORED, arguments)
    submitted = arguments["details"]["procedure"]
    assert submitted["score"] == analysis.procedure.score.score
    assert submitted["scoreVersion"] == "procedure-1"
    assert [each["name"] for each in submitted["trajectories"]] == [
        each.name for each in SCENARIO.procedure("seeg").trajectories
    ]
    first, errors = submitted["trajectories"][0], analysis.procedure.analysis.trajectories[0]
    assert first["targetMm"] == errors.target_point_error.mm
    assert first["keptMm"] == min(errors.kept_mm.values()) == errors.kept_mm[first["nearest"]]


def test_a_trial_with_another_version_of_the_plan_is_not_analyzed(record):
    done = replace(record.procedure, sha256="0" * 64)
    with pytest.raises(InputError, match="with a different plan from the procedure 'seeg'"):
        analyze_trial(replace(record, procedure=done), SCENARIO).scored(SCENARIO, REVEALED)
