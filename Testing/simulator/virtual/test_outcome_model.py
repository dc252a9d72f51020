"""Every statistic is tested against studies whose truth is known (a model, not the simulator)."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.study.outcomes import MAIN_OUTCOMES
from rastrainer_simulator.report.comparisons import compare_modes
from rastrainer_simulator.virtual.outcome_model import OutcomeModel, rejection_rates
from rastrainer_simulator.virtual.population import ModeEffect, Population
from Testing.drawn_study import draw_study

MODES = ("desktop", "hmd")
TASKS = 10


def model(**changes):
    return OutcomeModel([120.0] * TASKS, [1.5] * TASKS, **changes)


def test_the_fast_rejection_rates_match_those_of_the_report():
    truth = model(mode_time={"hmd": 1.05}, carries_practice=True)
    orders = [MODES[:: -1 if place % 2 else 1] for place in range(9)]
    quick = rejection_rates(truth, 9, MODES, 12, seed=9, orders=orders)
    random = np.random.default_rng(9)
    studies = [draw_study(truth, 9, MODES, random, orders) for _ in range(12)]
    reports = [compare_modes(study, MAIN_OUTCOMES, *MODES) for study in studies]
    for index, rates in enumerate(quick):
        found = [report[index] for report in reports]
        assert {one.outcome.name for one in found} == {rates.outcome}
        assert None not in [one.result.sequences for one in found]
        assert rates.t_test == np.mean([one.result.p < 0.05 for one in found])
        assert rates.holm == np.mean([one.adjusted_p < 0.05 for one in found])
        assert rates.ranks == np.mean([one.result.ranks.p < 0.05 for one in found])
        if rates.coverage is not None:
            ends = np.array([one.result.difference.interval for one in found]).T
            held = (ends[0] <= rates.true_difference) & (rates.true_difference <= ends[1])
            assert rates.coverage == np.mean(held)


def hands(population, mode="desktop", trials=(1,), trainees=2000):
    return [population.skill_of(i, mode, n, seed=0) for i in range(trainees) for n in trials]


def assert_scaled(one, other, pace, scatter):
    for factor, names in (
        (pace, ("speed_mm_s", "gain_per_s")),
        (1 / pace, ("reaction_s", "dwell_s")),
        (scatter, ("aim_sd_mm", "settled_mm", "drift_mm_s")),
    ):
        for name in names:
            assert getattr(other, name) / getattr(one, name) == pytest.approx(factor), name


def test_practice_and_mode_scale_pace_and_scatter_and_a_mode_misleads_the_aim():
    first, later = hands(Population(learning=0.2, accuracy_learning=0.1), trials=(1, 8), trainees=1)
    assert_scaled(first, later, pace=8**0.2, scatter=8**-0.1)
    effect = ModeEffect(speed=0.8, aim=1.5, bias_mm=(0.0, 2.0, 0.0))
    population = Population(modes={"hmd": effect}, interaction=0.0)
    (desktop,), (hmd,) = (hands(population, mode, trainees=1) for mode in MODES)
    assert_scaled(desktop, hmd, pace=0.8, scatter=1.5)
    assert (desktop.aim_bias_mm, hmd.aim_bias_mm) == ((0.0, 0.0, 0.0), (0.0, 2.0, 0.0))


def test_impossible_trainees_are_refused():
    with pytest.raises(InputError, match="learning exponents and lapses must be from 0 to 1"):
        Population(learning=-1.0)
    with pytest.raises(InputError, match="at most 5 mm"):
        Population(modes={"hmd": ModeEffect(bias_mm=(9.0, 0.0, 0.0))})
