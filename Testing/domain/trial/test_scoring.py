"""The score has the documented properties, and the charts of competence those simulated."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rastrainer.errors import InputError
from rastrainer.trial import scoring
from rastrainer.trial.lc_cusum import (
    FALSE_DISCOVERY,
    lc_cusum,
    lc_cusum_limit,
    log_likelihood_ratios,
    signal_probability,
)
from Testing.domain.trial.trial_records import gentle_score

REFERENCES = (
    scoring.ScoreReference(105.0, 0.6),
    scoring.ScoreReference(150.0, 0.43),
    scoring.ScoreReference(30.0, 0.9),
)
references = st.sampled_from(REFERENCES)
# Differences of a millisecond and of a nanometer count, from a second to a day, up to a meter.
trials = st.builds(
    scoring.ScoreMeasures,
    completion_time_s=st.floats(1.0, 86_400.0),
    tre_mm=st.floats(0.0, 1000.0),
    contact_time_s=st.floats(0.0, 1000.0),
    contact_path_mm=st.floats(0.0, 10_000.0),
    pressing_depth_mm=st.floats(0.0, 10.0),
    common_bias_mm=st.floats(0.0, 100.0),
)
acceptable = st.builds(
    scoring.ScoreMeasures,
    completion_time_s=st.floats(1.0, 86_400.0),
    tre_mm=st.floats(0.0, scoring.LIMIT_MM),
    contact_time_s=st.floats(0.0, scoring.CONTACT_LIMIT_S),
    contact_path_mm=st.floats(0.0, scoring.CONTACT_PATH_LIMIT_MM),
    pressing_depth_mm=st.floats(0.0, scoring.DEPTH_LIMIT_MM),
    common_bias_mm=st.floats(0.0, scoring.COMMON_BIAS_LIMIT_MM),
)
LIMITS = {
    "tre_mm": scoring.LIMIT_MM,
    "contact_time_s": scoring.CONTACT_LIMIT_S,
    "contact_path_mm": scoring.CONTACT_PATH_LIMIT_MM,
    "pressing_depth_mm": scoring.DEPTH_LIMIT_MM,
    "common_bias_mm": scoring.COMMON_BIAS_LIMIT_MM,
}
MEASURES = ("completion_time_s", *LIMITS)


def score(measures, reference):
    return scoring.score_trial(measures, reference).score


@settings(max_examples=40)
@given(st.sampled_from(MEASURES), trials, st.floats(1e-3, 1e4), references)
def test_faster_more_accurate_and_gentler_are_each_strictly_better(measure, trial, step, reference):
    worse = replace(trial, **{measure: getattr(trial, measure) + step})
    assert score(trial, reference) > score(worse, reference)


@settings(max_examples=40)
@given(st.sampled_from([*LIMITS]), trials, acceptable, st.floats(0.0, 1000.0), references)
def test_exceeding_a_limit_cannot_be_compensated(measure, trial, other, excess, reference):
    beyond = math.nextafter(LIMITS[measure], math.inf) + excess
    worse = scoring.score_trial(replace(trial, **{measure: beyond}), reference)
    assert not worse.acceptable
    assert not scoring.passes(worse.score, worse.acceptable, 0.0)
    assert worse.score < score(other, reference)


def test_scores_of_version_1_do_not_change():
    assert scoring.SCORE_VERSION == "1"
    reference = scoring.ScoreReference(100.0, 0.4)
    assert gentle_score(100.0, 0.4, reference).score == pytest.approx(100 * math.sqrt(0.52 * 0.5))
    assert gentle_score(50.0, 0.2, reference).score == pytest.approx(100 * math.sqrt(0.808 * 0.8))
    touched = scoring.score_trial(scoring.ScoreMeasures(100.0, 0.4, 4.0, 80.0, 1.5, 0.0), reference)
    assert touched.score == pytest.approx(100 * math.sqrt(0.52 * 0.5 / 8))
    beside = gentle_score(100.0, 0.4, reference, common_bias_mm=1.0)
    assert beside.accuracy_desirability == pytest.approx(0.25)
    assert gentle_score(100.0, 0.4, reference, common_bias_mm=0.5).score == pytest.approx(
        100 * math.sqrt(0.52 * 0.5 * 16 / 17)
    )
    worst = 0.04 / (1 + 3.75**2) / (1 + 1.5**4) / 5 / 5 / 2
    assert gentle_score(100.0, 3.0, reference).score == pytest.approx(
        100 * math.sqrt(worst * 0.52 / (1 + 7.5**2))
    )


def test_a_trial_whose_contacts_were_not_measured_has_no_score():
    with pytest.raises(InputError, match="pressing_depth_mm is missing"):
        scoring.ScoreMeasures.of(
            100.0, 0.4, 0.0, {"unintended_contact_time_s": 0.0, "unintended_contact_path_mm": 0.0}
        )


def test_the_probability_of_a_signal_is_that_of_simulated_trainees():
    rng = np.random.default_rng(0)
    failures = rng.random((4000, 25)) < 0.4
    signaled = [lc_cusum(row, 0.1, 0.4, 1.25).competent_at is not None for row in failures[:800]]
    exact = signal_probability(0.4, 25, 0.1, 0.4, 1.25)
    assert np.mean(signaled) == pytest.approx(exact, abs=0.05)


def test_the_limit_keeps_the_risk_and_competent_trainees_pass():
    limit = lc_cusum_limit(0.05, 0.4, 20)
    assert signal_probability(0.4, 20, 0.05, 0.4, limit) <= 0.05
    assert signal_probability(0.4, 20, 0.05, 0.4, limit - 1e-3) > 0.05
    assert signal_probability(0.05, 20, 0.05, 0.4, limit) > 0.9
    assert lc_cusum([True, True, *[False] * 12], 0.05, 0.4, limit).competent_at is not None
    with pytest.raises(InputError, match="3 trials cannot show competence"):
        lc_cusum_limit(0.05, 0.4, 3)


def test_eleven_trials_at_least_show_competence_at_the_accepted_risk():
    limit = lc_cusum_limit(0.05, 0.4, 30)
    assert lc_cusum([False] * 10, 0.05, 0.4, limit).competent_at is None
    assert lc_cusum([False] * 11, 0.05, 0.4, limit).competent_at == 11
    success, _failure = log_likelihood_ratios(0.05, 0.4)
    chances = [signal_probability(0.4, 30, 0.05, 0.4, count * success) for count in (10, 11)]
    assert chances[0] > FALSE_DISCOVERY > chances[1]
