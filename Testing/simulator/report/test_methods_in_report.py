"""The report compares methods of registration as it compares modes, where there are several."""

from __future__ import annotations

import numpy as np
import pytest

from rastrainer.study.study_data import StudyData
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.report import target_errors
from rastrainer_simulator.report.report import report_html
from rastrainer_simulator.statistics.intervals import mean
from rastrainer_simulator.statistics.paired import compare_paired
from Testing.simulator.report.test_report import cohort, words_of

pytestmark = pytest.mark.usefixtures("undrawn")

TRUE_MM = {"fiducials": 0.8, "landmarks": 2.4, "surface": 0.8}


def played(trainees=12, methods=tuple(TRUE_MM), modes=("desktop",), seed=3):
    """Return a study in which each trainee played each method once in each mode."""
    rng = np.random.default_rng(seed)
    rows = []
    for trainee in range(trainees):
        for mode in modes:
            for number, method in enumerate(rng.permutation(methods), 1):
                true = TRUE_MM[str(method)] * (1 + rng.normal(0, 0.2))
                values = {
                    "completion_time_s": 90.0,
                    "rmse_mm": 0.5 if method == "surface" else 1.5,
                    "expected_tre_mm": true * 1.1,
                    "tre_low_mm": 0.4 * true,
                    "tre_high_mm": 1.8 * true,
                    "true_tre_mm": true,
                    "score": 50.0,
                }
                name = f"T{trainee:03d}"
                others = {"method": str(method), "started_utc": f"2026-05-0{number}T09:00:00Z"}
                rows.append(TrialRow(name, mode, f"task-{number}", number, values, **others))
    return StudyData("Methods", tuple(rows), has_order=True)


def pair_of(data, first, second, outcome):
    """Return one comparison."""
    found = target_errors.compare_methods(target_errors.as_conditions(data))
    key = (first, second, outcome)
    return next(one for one in found if (one.first, one.second, one.outcome.name) == key)


def test_each_method_has_n_residual_expected_and_true_error_with_intervals():
    data = played()
    words = words_of(target_errors.method_comparison(data))
    for method, title in target_errors.TITLES.items():
        if method not in TRUE_MM:
            assert f"{title} 12 12" not in words
            continue
        true = np.array([t.values["true_tre_mm"] for t in data.trials if t.method == method])
        low, high = mean(true).interval
        text = f"{true.mean():.2f} [{low:.2f}, {high:.2f}]"
        residual = 0.5 if method == "surface" else 1.5
        assert f"{title} 12 12 {residual:.2f} [{residual:.2f}, {residual:.2f}]" in words
        assert f"{text} 12 of 12" in words
    assert target_errors.method_comparison(cohort(5)) == ""
    whole = words_of(report_html(data, "today"))
    assert "leaves out 12 trials by landmarks and 12 trials by surface" in whole
    assert "Differences between methods" in whole


def test_the_differences_are_those_of_the_shared_analysis_corrected_over_the_pairs():
    data = played()
    own = {
        method: {t.trainee: t.values["true_tre_mm"] for t in data.trials if t.method == method}
        for method in TRUE_MM
    }
    places = {(t.trainee, t.method): t.number for t in data.trials}
    trainees = [f"T{index:03d}" for index in range(12)]
    first, second = (np.array([own[m][t] for t in trainees]) for m in ("fiducials", "landmarks"))
    order = np.array(
        [np.sign(places[t, "landmarks"] - places[t, "fiducials"]) for t in trainees], dtype=float
    )
    expected = compare_paired(first, second, order)
    pair = pair_of(data, "fiducials", "landmarks", "true_tre_mm")
    assert pair.result.difference.value == pytest.approx(expected.difference.value)
    assert pair.result.p == pytest.approx(expected.p)
    assert expected.p < pair.adjusted_p < 0.001
    assert pair_of(data, "fiducials", "surface", "true_tre_mm").adjusted_p > 0.05
    assert pair_of(data, "fiducials", "surface", "rmse_mm").adjusted_p is None
    words = words_of(target_errors.method_comparison(data))
    assert f"(fiducials and landmarks) was {expected.difference.value:.2f} mm higher" in words
    assert "higher with landmarks than with fiducials" in words
    assert "correction for testing several pairs of methods" in words
    assert "(fiducials and trace): no difference is shown" in words
