"""Costs of decisions, the pass mark of a drill, and its figures by their published formulas."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from rastrainer.decision.drill_record import CASES, FAULTS, Decision, Fault
from rastrainer.decision.drill_score import (
    MOST_HARMFUL,
    MOST_VAIN,
    DrillEstimate,
    case_cost,
    difference,
    drill_score,
)
from Testing.drawn_drills import draw_drill

CASE = replace(draw_drill(np.random.default_rng(1)).cases[0], limit_mm=2.0, checks=())
SOUND = replace(CASE, true_error_mm=1.0, fault=Fault.NONE)
REPEATABLE = replace(CASE, true_error_mm=4.0, fault=Fault.BAD_FIDUCIAL)
LASTING = replace(CASE, true_error_mm=4.0, fault=Fault.BENT_TOOL)


def cost(case, decision):
    return case_cost(replace(case, decision=decision))


def drill(harmful, vain, half=CASES // 2):
    """Return the cases of a drill with so many errors of each kind."""
    return [
        replace(
            LASTING if row % 2 else REPEATABLE,
            decision=Decision.PROCEED if row < harmful else Decision.STOP,
        )
        for row in range(half)
    ] + [
        replace(SOUND, decision=Decision.REGISTER_AGAIN if row < vain else Decision.PROCEED)
        for row in range(half)
    ]


def test_each_case_has_one_cheapest_decision():
    cheapest = {
        Decision.PROCEED: SOUND,
        Decision.REGISTER_AGAIN: REPEATABLE,
        Decision.STOP: LASTING,
    }
    for right, case in cheapest.items():
        costs = {decision: cost(case, decision) for decision in Decision}
        assert min(costs, key=costs.get) is right
        assert sorted(costs.values())[1] > costs[right]


def test_a_drill_is_passed_with_few_errors_of_both_kinds():
    assert drill_score(drill(MOST_HARMFUL, MOST_VAIN)).is_passed
    assert not drill_score(drill(MOST_HARMFUL + 1, 0)).is_passed
    assert not drill_score(drill(0, MOST_VAIN + 1)).is_passed


@pytest.mark.parametrize("decision", Decision)
def test_one_decision_for_all_cases_never_passes(decision):
    score = drill_score([replace(case, decision=decision) for case in drill(0, 0)])
    assert not score.is_passed
    assert score.score < 25.0
    assert score.sensitivity.low < 0.0 < score.sensitivity.high


def test_sensitivity_and_criterion_are_those_of_corrected_rates():
    score = drill_score(drill(harmful=3, vain=1))
    hits, alarms = norm.ppf(7.5 / 11.0), norm.ppf(1.5 / 11.0)
    assert score.sensitivity.value == pytest.approx(hits - alarms)
    assert score.criterion.value == pytest.approx(-(hits + alarms) / 2.0)
    for each in (score.sensitivity, score.criterion):
        assert each.low < each.value < each.high


def test_a_perfect_drill_has_finite_figures():
    score = drill_score(drill(0, 0))
    for each in (score.sensitivity, score.criterion, score.ability):
        assert np.all(np.isfinite([each.value, each.low, each.high]))
    assert score.sensitivity.low > 1.0
    assert score.score > 90.0


def test_the_interval_of_a_difference_joins_both():
    before, after = DrillEstimate(1.0, 0.7, 1.4), DrillEstimate(2.0, 1.6, 2.3)
    gain = difference(after, before)
    assert gain.value == pytest.approx(1.0)
    assert gain.low == pytest.approx(1.0 - np.hypot(0.4, 0.4))
    assert gain.high == pytest.approx(1.0 + np.hypot(0.3, 0.3))


def test_the_brier_score_is_a_quarter_for_who_is_never_sure():
    unsure = [replace(case, confidence=50) for case in drill(4, 4)]
    assert drill_score(unsure).brier == pytest.approx(0.25)
    sure = [replace(case, confidence=100) for case in drill(0, 0)]
    assert drill_score(sure).brier == 0.0


def test_difficult_cases_show_more_ability():
    easy, hard = (
        drill_score([replace(case, difficulty=each) for case in drill(2, 2)])
        for each in (-2.0, 0.0)
    )
    assert hard.ability.value == pytest.approx(easy.ability.value + 2.0, abs=1e-6)


def test_missed_faults_are_counted_by_their_cause():
    cases = [
        replace(LASTING, fault=fault, decision=Decision.PROCEED if row % 2 else Decision.STOP)
        for row, fault in enumerate(FAULTS)
    ]
    missed = drill_score([*cases, *cases, SOUND]).missed
    assert missed == {fault: (2 * (row % 2), 2) for row, fault in enumerate(FAULTS)}


def test_a_case_is_right_if_it_proceeds_within_the_limit_or_refuses_beyond_it():
    for case in draw_drill(np.random.default_rng(1)).cases:
        assert case.is_sound == (case.true_error_mm <= case.limit_mm)
        assert case.is_right == (case.is_sound == (case.decision is Decision.PROCEED))


def test_every_fault_but_none_is_repeatable_or_has_a_cause_to_be_found():
    assert {*FAULTS, Fault.NONE} == set(Fault)
    repeatable = {Fault.BAD_FIDUCIAL, Fault.SWAPPED, Fault.SLID_TRACE, Fault.MOVED_HEAD}
    assert {fault for fault in FAULTS if fault.is_repeatable} == repeatable
