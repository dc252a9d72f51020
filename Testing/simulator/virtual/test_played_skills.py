"""What is true of virtual trainees comes through the arm, the contact and the registration."""

import numpy as np
import pytest

from rastrainer_simulator.virtual.play import PlaySettings, play_job
from rastrainer_simulator.virtual.population import FIRST_DAY, ModeEffect, Population, TrialJob
from rastrainer_simulator.virtual.scripted_trainee import Skill
from Testing.simulator.virtual.conftest import BRISK

FIRST, LATER = 1, 16


def played(population, mode, number, seed):
    skill = population.skill_of(0, mode, number, seed=0)
    return play_job(TrialJob("V0001", "s", mode, "task-1", skill, seed, FIRST_DAY), PlaySettings())


def exponent(learning, numbers, seeds):
    """Return the fitted b of the completion times of the same heads and hands."""
    population = Population(Skill(slip_at=None), 0.0, 0.0, learning)
    times = [
        [played(population, "desktop", number, seed).record.completion_time_s for seed in seeds]
        for number in numbers
    ]
    return -np.polyfit(np.log(numbers), np.log(times).mean(axis=1), 1)[0]


def test_the_asked_exponent_of_practice_is_played():
    """Hands whose gain stayed as it was gave 0.02 to 0.04 of 0.15."""
    assert exponent(0.3, (FIRST, LATER), (1, 2)) == pytest.approx(0.3, abs=0.04)


@pytest.mark.soak
@pytest.mark.parametrize("learning", [0.1, 0.15, 0.3])
def test_the_asked_exponent_of_practice_is_played_over_many_trials(learning):
    found = exponent(learning, (1, 2, 4, 8, 16), range(1, 7))
    assert found == pytest.approx(learning, abs=0.015)


def test_a_view_that_misleads_moves_the_target_more_than_the_residuals():
    modes = {"hmd": ModeEffect(bias_mm=(0.0, 0.0, 3.0))}
    population = Population(BRISK, 0.0, 0.0, 0.0, modes)
    errors = np.array(
        [
            [(trial.analysis.truth.true_tre_mm, trial.analysis.rigid.fre_mm) for trial in of_mode]
            for of_mode in (
                [played(population, mode, 1, seed) for seed in (1, 2, 3)]
                for mode in ("desktop", "hmd")
            )
        ]
    )
    tre, rmse = (errors[1] - errors[0]).T
    assert (tre > rmse).all()
    assert tre.mean() > 0.7 > rmse.mean()
