"""A report says what a comparison shows and cannot show, and no more."""

import math

import numpy as np

from rastrainer_simulator.report.paired_statistics import what_it_shows
from rastrainer_simulator.report.statistical_methods import what_cannot_be_concluded
from rastrainer_simulator.statistics.paired import compare_paired

rng = np.random.default_rng(3)
FOUR, TWENTY_FIVE = (rng.normal(0.4, 1.0, n) for n in (4, 25))


def test_the_limits_of_few_subjects_are_stated():
    four = compare_paired(np.zeros(4), FOUR)
    words = " ".join(what_cannot_be_concluded(4, four, order_known=False))
    assert "smallest possible p is .125" in words
    assert "did first is not in the data" in words
    assert "199, 34 or 15 subjects" in words
    assert "1.9 times" in words or "2.0 times" in words or "2.1 times" in words
    thirty = compare_paired(np.zeros(25), TWENTY_FIVE)
    assert "Wilcoxon" not in " ".join(what_cannot_be_concluded(25, thirty))
    assert "orders of the conditions do not allow the effect of the period" in " ".join(
        what_cannot_be_concluded(25, thirty)
    )
    assert "no comparison" in what_cannot_be_concluded(1)[0]


def test_a_difference_that_is_not_shown_is_not_called_absent():
    comparison = compare_paired(np.array([1.0, 2.0, 3.0]), np.array([1.2, 1.8, 3.4]))
    words = what_it_shows("Time", "s", "desktop", "hmd", comparison, 1.0)
    assert "not evidence that there is none" in words
    clear = compare_paired(np.zeros(9), np.linspace(1.0, 1.5, 9))
    assert "1.25 s higher with hmd" in what_it_shows("Time", "s", "desktop", "hmd", clear, 0.001)
    assert "does not hold" in what_it_shows("Time", "s", "desktop", "hmd", clear, 0.06)
    assert not math.isnan(clear.hedges_gz)
