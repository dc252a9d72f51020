"""A cohort played by the whole simulator: the study recovers the truth."""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.play import PlaySettings, play_job
from rastrainer_simulator.virtual.population import FIRST_DAY, ModeEffect, Population, TrialJob
from Testing.simulator.virtual.conftest import BRISK

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


def test_a_misleading_view_moves_the_target_more_than_the_residuals():
    modes = {"hmd": ModeEffect(bias_mm=(0.0, 0.0, 3.0))}
    # Exact hands: in one trial the scatter of others may hide what the view does.
    population = Population(replace(BRISK, aim_sd_mm=0.5), 0.0, 0.0, 0.0, modes)
    desktop, hmd = (played(population, mode, 1, 1).analysis for mode in ("desktop", "hmd"))
    tre_mm = hmd.truth.true_tre_mm - desktop.truth.true_tre_mm
    assert tre_mm > 0.7 > hmd.rigid.fre_mm - desktop.rigid.fre_mm
