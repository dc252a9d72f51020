"""Every statistic is tested against studies whose truth is known (a model, not the simulator)."""

import numpy as np
import pytest

from rastrainer.errors import InputError
from rastrainer.study.outcomes import MAIN_OUTCOMES
from rastrainer_simulator.report.comparisons import compare_modes
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.outcome_model import OutcomeModel, rejection_rates
from rastrainer_simulator.virtual.population import ModeEffect, Population
from Testing.drawn_study import draw_study

MODES = ("desktop", "hmd")
TASKS = 10


def model(**changes):
    return OutcomeModel([120.0] * TASKS, [1.5] * TASKS, **changes)


@pytest.mark.parametrize("alternating", [False, True])
def test_the_fast_rejection_rates_match_those_of_the_report(alternating):
    truth = model(mode_time={"hmd": 1.05}, carries_practice=True)
    orders = [MODES[:: -1 if place % 2 and alternating else 1] for place in range(9)]
    quick = rejection_rates(truth, 9, MODES, 12, seed=9, orders=orders)
    random = np.random.default_rng(9)
    studies = [draw_study(truth, 9, MODES, random, orders) for _ in range(12)]
    reports = [compare_modes(study, MAIN_OUTCOMES, *MODES) for study in studies]
    for index, rates in enumerate(quick):
        found = [report[index] for report in reports]
        assert {one.outcome.name for one in found} == {rates.outcome}
        assert {one.result.sequences is not None for one in found} == {alternating}
        assert rates.t_test == np.mean([one.result.p < 0.05 for one in found])
        assert rates.holm == np.mean([one.adjusted_p < 0.05 for one in found])
        assert rates.ranks == np.mean([one.result.ranks.p < 0.05 for one in found])
        if rates.coverage is not None:
            ends = np.array([one.result.difference.interval for one in found]).T
            held = (ends[0] <= rates.true_difference) & (rates.true_difference <= ends[1])
            assert rates.coverage == np.mean(held)


def test_the_same_seed_gives_the_same_trainees_however_many():
    population = Population(learning=0.2)
    desktop = population.skill_of(3, "desktop", 1, seed=4)
    assert population.skill_of(3, "desktop", 1, seed=4) == desktop
    assert population.skill_of(4, "desktop", 1, seed=4) != desktop


def test_the_median_and_spread_of_the_population_are_as_specified():
    population = Population(skill=Skill(speed_mm_s=100.0, aim_sd_mm=1.0))
    skills = [population.skill_of(i, "desktop", 1, seed=0) for i in range(2000)]
    for values, typical in (
        ([s.speed_mm_s for s in skills], 100.0),
        ([s.aim_sd_mm for s in skills], 1.0),
    ):
        assert np.median(values) == pytest.approx(typical, rel=0.02)
        assert np.std(np.log(values)) == pytest.approx(0.15, rel=0.05)


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


def test_practice_improves_pace_and_scatter_by_their_own_exponents():
    first, later = hands(Population(learning=0.2, accuracy_learning=0.1), trials=(1, 8), trainees=1)
    assert_scaled(first, later, pace=8**0.2, scatter=8**-0.1)


def test_a_mode_scales_pace_and_scatter_and_misleads_the_aim():
    effect = ModeEffect(speed=0.8, aim=1.5, bias_mm=(0.0, 2.0, 0.0))
    population = Population(modes={"hmd": effect}, interaction=0.0)
    (desktop,), (hmd,) = (hands(population, mode, trainees=1) for mode in MODES)
    assert_scaled(desktop, hmd, pace=0.8, scatter=1.5)
    assert (desktop.aim_bias_mm, hmd.aim_bias_mm) == ((0.0, 0.0, 0.0), (0.0, 2.0, 0.0))


def test_modes_suit_trainees_differently_only_with_an_interaction():
    for sd in (0.0, 0.1):
        population = Population(interaction=sd)
        ratios = [
            hmd.speed_mm_s / desktop.speed_mm_s
            for desktop, hmd in zip(
                hands(population, trainees=500), hands(population, "hmd", trainees=500), strict=True
            )
        ]
        assert np.std(np.log(ratios)) == pytest.approx(np.sqrt(2) * sd, rel=0.1, abs=1e-12)


def test_a_hasty_trial_scatters_more_by_the_trade_off_exponent():
    population = Population(
        speed_spread=0.0, aim_spread=0.0, learning=0.0, tempo_spread=0.1, trade_off=0.7
    )
    skills = hands(population, trials=range(1, 21), trainees=100)
    speed, aim = (np.log([getattr(s, n) for s in skills]) for n in ("speed_mm_s", "aim_sd_mm"))
    assert np.std(speed) == pytest.approx(0.1, rel=0.1)
    assert np.polyfit(speed, aim, 1)[0] == pytest.approx(0.7)


def test_lapses_occur_in_their_share_of_trials():
    slips = [skill.slip_at is not None for skill in hands(Population(lapses=0.3))]
    assert np.mean(slips) == pytest.approx(0.3, abs=0.03)
    assert {skill.slip_at for skill in hands(Population(), trainees=9)} == {Skill().slip_at}


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"learning": -1.0}, "learning exponents and lapses must be from 0 to 1"),
        ({"trade_off": 3.0}, "speed and accuracy must be from 0 to 2"),
        ({"modes": {"hmd": ModeEffect(aim=0.0)}}, "factors from 0.1 to 10"),
        ({"modes": {"hmd": ModeEffect(bias_mm=(9.0, 0.0, 0.0))}}, "at most 5 mm"),
    ],
)
def test_impossible_trainees_are_refused(changes, sentence):
    with pytest.raises(InputError, match=sentence):
        Population(**changes)
