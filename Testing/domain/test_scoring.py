"""Our score keeps each word it promises."""

import inspect
import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rastrainer import scoring
from rastrainer.errors import InputError
from rastrainer.scoring import (
    TASK_REFERENCES,
    ScoreReference,
    TrialScore,
    score_trial,
    task_reference,
)

# Differences of a millisecond and of a nanometer count, from a second to a day, up to a meter.
times = st.floats(1.0, 86_400.0)
errors = st.floats(0.0, 1000.0)
references = st.sampled_from(list(TASK_REFERENCES.values()))
steps_s = st.floats(1e-3, 1e4)
steps_mm = st.floats(1e-6, 100.0)


def score(time, error, reference):
    return score_trial(time, error, reference).score


@given(st.floats(1e-3, 1e6), st.floats(0.0, 1e6), references)
def test_bounded_from_0_to_100(time, error, reference):
    assert 0.0 < score(time, error, reference) <= 100.0


@given(times, steps_s, errors, references)
def test_faster_is_strictly_better(time, step, error, reference):
    assert score(time, error, reference) > score(time + step, error, reference)


@given(times, errors, steps_mm, references)
def test_more_accurate_is_strictly_better(time, error, step, reference):
    assert score(time, error, reference) > score(time, error + step, reference)


@given(times, times, errors, errors, references)
def test_an_unacceptable_error_is_never_bought_back(time, other_time, error, excess, reference):
    acceptable = min(error, reference.limit_mm)
    unacceptable = math.nextafter(reference.limit_mm, math.inf) + excess
    worse = score_trial(time, unacceptable, reference)
    assert not worse.acceptable
    assert worse.score < score(other_time, acceptable, reference)


def test_one_trial_is_enough_and_the_mode_plays_no_part():
    assert list(inspect.signature(score_trial).parameters) == [
        "completion_time_s",
        "expected_tre_mm",
        "reference",
    ]
    assert list(inspect.signature(task_reference).parameters) == ["task"]


@given(times, times, errors, errors)
def test_what_is_better_in_both_is_better_whatever_the_references(time, more, error, worse):
    """Mode, cohort and task only choose a reference; the order of trials is the same with all."""
    better, worse_trial = (min(time, more), min(error, worse)), (max(time, more), max(error, worse))
    for reference in TASK_REFERENCES.values():
        assert score(*better, reference) >= score(*worse_trial, reference)


@given(times, errors, references)
def test_a_score_survives_json_with_its_version_and_references(time, error, reference):
    trial = score_trial(time, error, reference)
    again = TrialScore.from_json(json.loads(json.dumps(trial.to_json())))
    assert again == trial
    assert again.version == scoring.SCORE_VERSION
    recomputed = score_trial(again.completion_time_s, again.expected_tre_mm, again.reference)
    assert recomputed.score == trial.score


def test_the_score_is_the_geometric_mean_of_its_parts():
    trial = score_trial(80.0, 0.7, task_reference("task-2"))
    assert trial.score == pytest.approx(
        100 * math.sqrt(trial.time_desirability * trial.accuracy_desirability)
    )


def test_version_1_keeps_its_values():
    assert scoring.SCORE_VERSION == "1"
    assert {task: (r.time_s, r.tre_mm, r.limit_mm) for task, r in TASK_REFERENCES.items()} == {
        "trial-run": (100.0, 0.4, 2.0),
        "task-1": (105.0, 0.4, 2.0),
        "task-2": (125.0, 0.4, 2.0),
        "task-3": (130.0, 0.4, 2.0),
        "task-4": (135.0, 0.4, 2.0),
        "task-5": (140.0, 0.4, 2.0),
    }
    reference = ScoreReference(100.0, 0.4, 2.0)
    assert score(100.0, 0.4, reference) == pytest.approx(100 * math.sqrt(0.52 * 0.5))
    assert score(50.0, 0.2, reference) == pytest.approx(100 * math.sqrt(0.808 * 0.8))
    assert score(100.0, 3.0, reference) == pytest.approx(
        100 * math.sqrt(0.52 * 0.04 / (1 + 7.5**2))
    )


def test_the_score_tells_what_it_was_measured_against():
    trial = score_trial(100.0, 0.5, task_reference("task-1")).to_json()
    assert trial["version"] == "1"
    assert (trial["reference_time_s"], trial["reference_tre_mm"]) == (105.0, 0.4)


@pytest.mark.parametrize("time", [0.0, -1.0, math.nan, math.inf])
def test_a_time_that_is_none_is_refused(time):
    with pytest.raises(InputError, match="completion time"):
        score_trial(time, 1.0, task_reference("task-1"))


@pytest.mark.parametrize("error", [-0.1, math.nan, math.inf])
def test_an_error_that_is_none_is_refused(error):
    with pytest.raises(InputError, match="expected target error"):
        score_trial(100.0, error, task_reference("task-1"))


def test_an_unknown_task_is_told_the_known_ones():
    with pytest.raises(InputError, match=r"'task-9' has no reference .* trial-run, task-1"):
        task_reference("task-9")
