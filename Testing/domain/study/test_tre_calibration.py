"""Calibration of expected target errors, and its section in the report."""

import numpy as np
import pytest
from scipy import stats

from rastrainer.registration.distributions import proportion
from rastrainer.registration.target_error import INTERVAL_NOTE
from rastrainer.study.study_data import StudyData
from rastrainer.study.tre_calibration import calibration_of
from rastrainer.trial.trial_row import TrialRow
from rastrainer_simulator.report.target_errors import calibration

KNOWN = {"expected_tre_mm": 0.5, "tre_low_mm": 0.1, "tre_high_mm": 1.0}


def row(number, mode="desktop", **values):
    return TrialRow("T-001", mode, "task-1", number, {"completion_time_s": 90.0, **values})


def report(*rows):
    # A number and its unit stay on one line.
    return calibration(StudyData("Study", rows)).replace("\N{NO-BREAK SPACE}", " ")


def test_trials_are_ordered_by_expected_error_and_judged_by_their_interval():
    trials = [{"true_tre_mm": 2.0, "expected_tre_mm": 0.9}, {"true_tre_mm": 0.3}]
    trials += [{"true_tre_mm": 0.05}]
    found = calibration_of(row(1, **KNOWN | errors) for errors in trials)
    assert [one.expected_mm for one in found.points] == [0.5, 0.5, 0.9]
    assert [one.is_inside for one in found.points] == [False, True, False]
    assert found.above == 1
    assert found.true_rms_mm == pytest.approx(np.sqrt((4 + 0.09 + 0.0025) / 3))


@pytest.mark.parametrize(("count", "total"), [(0, 3), (3, 3), (57, 60), (1, 1)], ids=str)
def test_the_interval_of_a_proportion_is_wilsons(count, total):
    theirs = stats.binomtest(count, total).proportion_ci(0.95, "wilson")
    found = proportion(count, total).interval
    assert found == pytest.approx((theirs.low, theirs.high), abs=1e-12)


def test_few_trials_and_missing_errors_have_a_sentence():
    known = [row(1, **KNOWN, true_tre_mm=error) for error in (0.3, 0.4)]
    sentences = calibration_of([*known, *[row(1, **KNOWN)] * 3]).sentences()
    assert "2 of 2 true errors" in sentences[0]
    assert sentences[1:] == [
        "2 trials can say nothing about a share.",
        "3 trials have no true target error and cannot be shown.",
    ]


def test_the_report_counts_missing_errors_and_separates_modes():
    page = report(
        *(row(n, **KNOWN, true_tre_mm=0.4, tre_common_bias_sd_mm=0.25) for n in range(1, 8)),
        row(1, "hmd", **KNOWN, true_tre_mm=3.0, tre_common_bias_sd_mm=0.25),
        row(2, "hmd", **KNOWN),
        row(3, "hmd"),
    )
    assert "7 of 8 true errors (88 % [53, 98])" in page
    assert "larger: 1, smaller: 0" in page
    assert page.count("cannot be shown") == 2
    assert "of the intervals were computed before" not in page
    assert ">all</th><td>8</td>" in page
    assert "T-001, task-1: true 3.00 mm, expected 0.50 mm" in page
    assert INTERVAL_NOTE in page


def test_a_study_without_target_errors_has_no_calibration_section():
    assert report(row(1), row(2)) == ""
    assert "No trial has both" in report(row(1, **KNOWN))
