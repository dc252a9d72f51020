"""The report tells what of the target point error the registration and the hands caused."""

import re

import pytest

from rastrainer_simulator.report.procedures import procedures
from Testing.simulator.report.studied_procedures import TOO_DEEP_MM, with_procedures
from Testing.simulator.report.test_report import cohort, words_of
from Testing.simulator.report.without_charts import without_charts


def words_with(**options):
    with without_charts():
        return words_of(procedures(with_procedures(cohort(4), **options)))


@pytest.fixture(scope="module")
def words():
    return words_with()


def test_the_split_is_reported_over_all_kinds_and_for_each(words):
    assert "24 of 24 trials continued with a procedure: 48 lines in all, by 4 trainees." in words
    assert f"48 lines were aligned by hand: there the hands caused {TOO_DEEP_MM:.2f} mm." in words
    assert "by the robot: there" not in words
    # Shifts of 0.5, 1.0, 1.5 and 2.0 mm in turn: RMS 1.37 mm.
    assert "the part that the registration caused was 1.37 mm" in words
    for kind in ("Biopsy 8 16 4", "DBS 8 16 4", "SEEG 8 16 4", "all 24 48 4"):
        assert kind in words


def test_what_the_robot_aligned_is_not_counted_as_done_by_hand(words):
    mixed = words_with(by_robot=True)
    assert f"24 lines were aligned by hand: there the hands caused {TOO_DEEP_MM:.2f} mm." in mixed
    assert "24 lines were aligned by the robot: there robot and hands caused 2.40 mm" in mixed
    assert "all 24 48 (24) 4" in mixed
    assert comparison(mixed) == comparison(words)


def comparison(words):
    """The sentence that compares each trainee's hands with the registration."""
    return re.search(r"registration minus hands, .*?\]", words)[0]


def test_the_error_over_trainees_has_an_interval_and_the_limits_are_stated(words):
    found = re.search(r"own RMS was (\d\.\d\d) mm on average \[95 %: (\S+), (\S+)\]", words)
    value, low, high = (float(number) for number in found.groups())
    assert low < value < high
    assert re.search(r"registration minus hands, as RMS of each trainee, was −?\d\.\d\d mm", words)
    assert procedures(cohort(2)) == ""
