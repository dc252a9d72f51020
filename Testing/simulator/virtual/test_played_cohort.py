"""A cohort played by the whole simulator: the study recovers the truth."""

import numpy as np
import pytest

from rastrainer.study.outcomes import MAIN_OUTCOMES
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.report.comparisons import compare_modes
from rastrainer_simulator.virtual.cohort import DATABASE, simulate_cohort
from rastrainer_simulator.virtual.play import PlaySettings, play_job
from rastrainer_simulator.virtual.population import FIRST_DAY, ModeEffect, Population, TrialJob
from rastrainer_simulator.virtual.scripted_trainee import Skill
from Testing.simulator.virtual.conftest import AIM_FACTOR, BRISK

FIRST, LATER = 1, 16


def played(population, mode, number, seed):
    skill = population.skill_of(0, mode, number, seed=0)
    return play_job(TrialJob("V0001", "s", mode, "task-1", skill, seed, FIRST_DAY), PlaySettings())


def exponent(learning, numbers, seeds):
    """Return the fitted b of the completion times of the same heads and hands."""
    population = Population(Skill(slip_at=None), 0.0, 0.0, learning)
    times = [
        [
            played(population, "desktop", number, seed).analysis.record.completion_time_s
            for seed in seeds
        ]
        for number in numbers
    ]
    return -np.polyfit(np.log(numbers), np.log(times).mean(axis=1), 1)[0]


def test_the_given_learning_exponent_is_played():
    """Hands whose gain stayed as it was gave 0.02 to 0.04 of 0.15."""
    assert exponent(0.3, (FIRST, LATER), (1,)) == pytest.approx(0.3, abs=0.04)


@pytest.mark.soak
@pytest.mark.parametrize("learning", [0.1, 0.15, 0.3])
def test_the_given_learning_exponent_is_played_over_many_trials(learning):
    found = exponent(learning, (1, 2, 4, 8, 16), range(1, 7))
    assert found == pytest.approx(learning, abs=0.015)


def test_a_misleading_view_moves_the_target_more_than_the_residuals():
    modes = {"hmd": ModeEffect(bias_mm=(0.0, 0.0, 3.0))}
    population = Population(BRISK, 0.0, 0.0, 0.0, modes)
    errors = np.array(
        [
            [(trial.analysis.truth.true_tre_mm, trial.analysis.rigid.fre_mm) for trial in of_mode]
            for of_mode in (
                [played(population, mode, 1, seed) for seed in (1, 2)]
                for mode in ("desktop", "hmd")
            )
        ]
    )
    tre, rmse = (errors[1] - errors[0]).T
    assert (tre > rmse).all()
    assert tre.mean() > 0.7 > rmse.mean()


TRAINEES = 20


@pytest.mark.soak
def test_the_effect_of_a_mode_is_found_where_it_exists_and_with_its_size(tmp_path):
    """Minutes on two cores; each trainee plays one task in both modes."""
    protocol = StudyProtocol("soak", "Soak", ("desktop", "hmd"), "balanced", ("task-1",), "fixed")
    effect = {"hmd": ModeEffect(aim=AIM_FACTOR)}
    population = Population(skill=BRISK, learning=0.0, modes=effect)
    run = simulate_cohort(protocol, population, TRAINEES, 11, tmp_path / "study", PlaySettings())
    assert (run.played, run.stuck) == (2 * TRAINEES, 0)
    data = read_study_data(tmp_path / "study" / DATABASE)
    found = {c.outcome.name: c for c in compare_modes(data, MAIN_OUTCOMES, "desktop", "hmd")}
    squares = [np.mean(np.square(m)) for m in _means(found["rmse_mm"])]
    assert np.sqrt(squares[1] / squares[0]) == pytest.approx(AIM_FACTOR, rel=0.15)
    assert found["rmse_mm"].adjusted_p < 1e-4
    assert found["score"].adjusted_p < 0.01


def _means(comparison):
    return comparison.first_means, comparison.second_means
