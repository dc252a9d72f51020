"""CTPS: the paper's own numbers, and its properties."""

from pathlib import Path

import pytest

from rastrainer.trial.ctps import RMSE, TIME, read_trials, score_cohort, trials_by_mode
from rastrainer.trial.trial_row import TrialRow

STUDY = Path(__file__).parents[3] / "assets" / "studies" / "published.csv"
PRINTED_MEAN_CT = {"hmd": None, "desktop": 129.42}

TABLE_1 = {
    "tasks": {"1": "79.70", "2": "75.43", "3": "75.27", "4": "37.10", "5": "56.59"},
    "subjects": {"1": "63.76", "2": "66.31", "3": "65.12", "4": "64.09"},
}
TABLE_2 = {
    "tasks": {"1": "77.61", "2": "86.42", "3": "68.72", "4": "37.52", "5": "66.18"},
    "subjects": {"1": "81.72", "2": "58.83", "3": "68.37", "4": "60.22"},
}


@pytest.fixture(scope="module")
def published():
    modes = trials_by_mode(read_trials(STUDY))
    return {mode: score_cohort(trials, PRINTED_MEAN_CT[mode]) for mode, trials in modes.items()}


def trial(task="1", time_s=10.0, rmse_mm=1.0):
    return TrialRow("a", "desktop", task, values={TIME: time_s, RMSE: rmse_mm})


def printed(means):
    return {name: f"{value:.2f}" for name, value in means.items()}


@pytest.mark.parametrize(("mode", "table"), [("hmd", TABLE_1), ("desktop", TABLE_2)])
def test_every_task_and_user_mean_is_as_printed(mode, table, published):
    assert printed(published[mode].tasks) == table["tasks"]
    assert printed(published[mode].subjects) == table["subjects"]


def test_overall_scores_and_correlations_are_as_printed_and_equation_3_yields_half(published):
    assert f"{published['hmd'].overall:.3f}" == "64.818"
    assert f"{published['hmd'].sd_population:.2f}" == "25.47"
    assert f"{published['desktop'].overall:.2f}" == "67.29"
    assert f"{published['desktop'].sd_sample:.2f}" == "25.96"
    # The printed "r squared" are correlations.
    assert f"{published['hmd'].pearson_r:.3f}" == "0.963"
    assert f"{published['desktop'].pearson_r:.3f}" == "0.919"
    assert f"{published['hmd'].r_squared:.3f}" == "0.928"
    assert f"{published['desktop'].r_squared:.3f}" == "0.845"
    assert f"{published['hmd'].equation_3_overall:.1f}" == "32.4"
    assert f"{published['desktop'].equation_3_overall:.1f}" == "33.6"


def test_tasks_are_numbered_by_the_digits_of_their_names():
    trials = [
        trial(name, time)
        for name, time in [
            ("task-2", 20.0),
            ("trial-run", 500.0),
            ("task-10", 100.0),
            ("task-4", 40.0),
        ]
    ]
    assert score_cohort(trials).pearson_r == pytest.approx(1.0)
