"""A report says what a comparison shows and cannot show, and no more."""

import numpy as np

from rastrainer.study.outcomes import Outcome
from rastrainer.study.study_data import StudyData
from rastrainer_simulator.report.comparisons import ModeComparison
from rastrainer_simulator.report.conclusions import answers, limits
from rastrainer_simulator.statistics.paired import compare_paired
from Testing.simulator.report.test_report import words_of

TIME = Outcome("completion_time_s", "Time", unit="s", digits=1)
DATA = StudyData("A study", ())
rng = np.random.default_rng(3)
FOUR, TWENTY_FIVE = (rng.normal(0.4, 1.0, n) for n in (4, 25))


def comparison(differences, order=None, adjusted_p=1.0):
    """Return a comparison of two modes of which the first is 0."""
    differences = np.asarray(differences, dtype=float)
    zeros, names = np.zeros(len(differences)), tuple(f"T{n}" for n in range(len(differences)))
    result = compare_paired(zeros, differences, order) if len(names) > 1 else None
    return ModeComparison(
        TIME, "desktop", "hmd", names, zeros, differences, order, result, adjusted_p
    )


def limits_of(*differences_and_order):
    return words_of(limits(DATA, [comparison(*differences_and_order)]))


def answers_of(differences, adjusted_p=1.0):
    found = comparison(differences, adjusted_p=adjusted_p)
    return words_of(answers(DATA, [found], [], [], {}, None))


def test_the_limits_of_few_subjects_are_stated():
    words = limits_of(FOUR)
    assert "smallest possible p is .125" in words
    assert "did first is not in the data" in words
    assert "199, 34 or 15 subjects" in words
    same = limits_of(TWENTY_FIVE, np.ones(25))
    assert "Wilcoxon" not in same
    assert "orders of the conditions do not allow the effect of the period" in same
    assert "One subject allows no comparison" in limits_of([1.0])


def test_a_difference_that_is_not_shown_is_not_called_absent():
    assert "not evidence that there is none" in answers_of([0.2, -0.2, 0.4])
    clear = np.linspace(1.0, 1.5, 9)
    words = answers_of(clear, 0.001)
    assert "1.25 s higher with the headset" in words
    assert "this holds after correction" in words
    assert "does not hold" in answers_of(clear, 0.06)
