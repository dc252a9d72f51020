"""Estimates of the variation of trials are unbiased."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer.report.report import report_html
from rastrainer.report.sections.variation import study_variation, variation
from rastrainer.statistics.variation import Trials, fit_variation, trade_off
from rastrainer_simulator.virtual.outcome_model import draw_outcomes, expected_outcomes
from Testing.error_rates.recovery import MODEL, PROTOCOL, draw_protocol_study

NOISELESS = {"trainee_time_sd": 0.0, "interaction_sd": 0.0, "trial_time_sd": 0.0}


def drawn(trainees=12, seed=1, protocol=PROTOCOL, **changes):
    random = np.random.default_rng(seed)
    return draw_protocol_study(replace(MODEL, **changes), protocol, trainees, random)


def test_noise_free_parameters_are_recovered_exactly():
    time = study_variation(drawn(**NOISELESS)).time
    assert time.learning == pytest.approx(MODEL.learning, abs=1e-12)
    assert time.lapse == pytest.approx(np.log(MODEL.lapse_time), abs=1e-12)
    assert time.modes == pytest.approx([0.0, np.log(MODEL.mode_time["hmd"])], abs=1e-12)
    assert (time.trainee_variance, time.interaction_variance) == pytest.approx((0, 0), abs=1e-12)


def test_the_components_of_variance_are_those_of_a_balanced_analysis():
    """Without practice, tasks and lapses they are the textbook's mean squares."""
    random = np.random.default_rng(2)
    shape = (6, 2, 8)
    values = random.normal(0, 0.3, (6, 1, 1)) + random.normal(0, 0.2, (6, 2, 1))
    values = values + random.normal(0, 0.1, shape)
    trainees, modes, _ = (axis.ravel() for axis in np.indices(shape))
    # As many early as late trials in every cell, so that practice takes nothing from the levels.
    numbers = np.tile([1, 2, 3, 4, 4, 3, 2, 1], 12)
    trials = Trials(trainees, modes, 0 * modes, numbers, np.zeros(96))
    found = fit_variation(trials, np.exp(values.ravel()))
    cells, rows = values.mean(axis=2), values.mean(axis=(1, 2))
    both = cells - rows[:, None] - cells.mean(axis=0) + values.mean()
    ms_both, ms_rows = 8 * (both**2).sum() / 5, 16 * rows.var(ddof=1)
    # Of the levels chance is known but for practice, which all of them share.
    assert found.interaction_variance == pytest.approx(
        (ms_both - found.trial_variance) / 8, abs=1e-12
    )
    assert found.trainee_variance == pytest.approx((ms_rows - ms_both) / 16, abs=1e-12)


def test_the_interval_of_practice_holds_the_truth_as_often_as_it_says():
    found = [study_variation(drawn(seed=seed)).time for seed in range(200)]
    held = [abs(one.learning - MODEL.learning) < 1.98 * one.learning_error for one in found]
    assert 0.91 <= np.mean(held) <= 0.985


def test_the_interval_of_the_trade_off_holds_the_truth_as_often_as_it_says():
    found = [study_variation(drawn(seed=seed)) for seed in range(200)]
    told = [trade_off(one.time, one.error) for one in found]
    held = [abs(k - MODEL.trade_off) < 1.98 * error for k, error in told]
    assert 0.91 <= np.mean(held) <= 0.985


@pytest.mark.parametrize(
    "study",
    [
        drawn(trainees=3),
        drawn(protocol=replace(PROTOCOL, modes=("hmd",))),
        replace(drawn(), has_order=False),
        replace(drawn(), trials=drawn().trials[::7]),
    ],
    ids=["three trainees", "one mode", "no order", "hardly any trials"],
)
def test_estimates_that_the_trials_do_not_allow_are_omitted(study):
    assert study_variation(study) is None
    assert variation(study) == ""


def test_trainees_without_all_modes_are_left_out():
    whole = drawn()
    lacking = tuple(t for t in whole.trials if (t.trainee, t.mode) != ("V0001", "hmd"))
    without = tuple(t for t in whole.trials if t.trainee != "V0001")
    found, expected = (
        study_variation(replace(whole, trials=trials)) for trials in (lacking, without)
    )
    assert found.trainees == 11
    assert found.time.learning == expected.time.learning


def test_the_report_has_a_table_of_variation_with_n():
    page = report_html(drawn())
    assert "What completion time and error vary with" in page
    assert "120 trials of the 12 trainees who did every mode" in page
    assert "Trainee × mode (SD)" in page
    assert "Headset (HMD) against Desktop" in page
    study = study_variation(drawn())
    assert f"{study.time.learning:.3f} [" in page


def test_the_expected_outcomes_are_the_means_of_very_many_trainees():
    modes = ("desktop", "hmd")
    orders = [modes, modes[::-1]] * 30_000
    found = draw_outcomes(MODEL, 60_000, modes, np.random.default_rng(3), orders)
    for values, expected in zip(found, expected_outcomes(MODEL, modes), strict=True):
        assert values.mean(axis=0) == pytest.approx(expected, rel=0.005)


def test_a_bias_of_the_view_moves_the_target_and_leaves_the_residuals():
    plain, biased = (drawn(mode_bias_mm=bias) for bias in ({}, {"desktop": 2.0, "hmd": 2.0}))
    for one, other in zip(plain.trials, biased.trials, strict=True):
        assert other.values["rmse_mm"] == one.values["rmse_mm"]
    true = [np.mean([t.values["true_tre_mm"] for t in s.trials]) for s in (plain, biased)]
    assert true[0] < 0.6
    assert true[1] == pytest.approx(2.0, abs=0.1)
