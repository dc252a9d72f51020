"""A trial's record becomes numbers, and the numbers JSON."""

import uuid

import numpy as np
import pytest

from rastrainer import transforms
from rastrainer.json_records import record_from_json
from rastrainer.trial.analysis import RevealedTruth, analyze_trial
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.score_reference import fiducial_normals, region_of
from rastrainer.trial.scoring import ScoreReference


@pytest.fixture
def record(make_record):
    return record_from_json(TrialRecord, make_record(str(uuid.UUID(int=1))))


def truth_of(scenario, seed=1):
    pose = scenario.perturbed_head_to_world(seed)
    return RevealedTruth(tuple(pose.ravel().tolist()), 0.3)


def test_all_three_kinds_are_fitted_and_the_true_error_of_the_rigid_one_is_scored(scenario, record):
    truth = truth_of(scenario)
    analysis = analyze_trial(record, scenario).scored(scenario, truth)
    assert set(analysis.fits) == {"rigid", "similarity", "affine"}
    region = region_of(scenario)
    errors = [
        np.linalg.norm(
            transforms.apply(analysis.rigid.matrix @ truth.matrix, points) - points, axis=1
        )
        for points in (region.targets, region.grid)
    ]
    expected = np.sqrt((np.mean(errors[0] ** 2) + np.mean(errors[1] ** 2)) / 2)
    assert analysis.score.measures.tre_mm == pytest.approx(expected)
    assert 0 < analysis.score.score < 100


def test_a_common_bias_is_scored_and_reported_until_the_truth_is_unknown(scenario, make_record):
    value, truth = make_record(str(uuid.UUID(int=1))), truth_of(scenario)
    task, normals = scenario.task("task-1"), fiducial_normals(scenario, "task-1")
    # The part along the skin of a shift to the patient's right.
    shift = np.array([1.0, 0.0, 0.0])
    aims = task.fiducials - 1.4 * (shift - normals * (normals @ shift)[:, None])
    for point in value["points"]:
        aim = aims[task.labels.index(point["label"])]
        point["positionMm"] = transforms.apply(truth.matrix, aim).tolist()
    beside = analyze_trial(record_from_json(TrialRecord, value), scenario).scored(scenario, truth)
    assert beside.score.measures.common_bias_mm == pytest.approx(1.4)
    assert beside.score.acceptable
    (advice,) = [each for each in beside.feedback.advice if "common bias" in each.sentence.key]
    assert "the touches are 1.4 mm too far to the patient's left" in advice.sentence
    stored = analyze_trial(record_from_json(TrialRecord, value), scenario)
    again = stored.scored_as(beside.score, scenario, truth)
    assert again.feedback.advice == beside.feedback.advice
    unknown = stored.scored_as(beside.score, scenario, None).feedback.advice
    assert not any("common bias" in one.sentence.key for one in unknown)


def test_the_protocols_references_apply(scenario, record):
    def score(**others):
        return analyze_trial(record, scenario).scored(scenario, truth_of(scenario), **others).score

    strict = {record.task: ScoreReference(20.0, 0.1, 0.5)}
    assert score(references=strict).score < score().score
    assert score(references={"task-5": strict[record.task]}) == score()
