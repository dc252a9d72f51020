"""A trial with a procedure is analyzed and scored with its truth, from the record alone."""

import json
from dataclasses import replace

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.commands import CommandName, check_arguments
from rastrainer.errors import InputError
from rastrainer.json_records import record_from_json, record_to_json
from rastrainer.registration.registration import register
from rastrainer.scenario.scenario import load_scenario
from rastrainer.trial.analysis import RevealedTruth, analyze_trial, score_arguments
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.scoring import SAFETY_METRICS
from rastrainer_simulator.assets import asset_path
from Testing.domain.procedure.procedure_records import recorded
from Testing.domain.trial.trial_records import make_record

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


def test_the_score_of_the_registration_equals_that_of_a_trial_with_touches_only(record):
    alone = replace(record, procedure=None)
    scored = analyze_trial(alone, SCENARIO).scored(SCENARIO, REVEALED)
    assert scored.procedure is None
    assert scored.score == analyze_trial(record, SCENARIO).scored(SCENARIO, REVEALED).score
    assert "procedure" not in score_arguments(scored)["details"]


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
