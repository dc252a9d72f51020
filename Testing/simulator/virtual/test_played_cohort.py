"""A cohort that is really played by the whole simulator: the truth comes back out of the study."""

import numpy as np
import pytest

from rastrainer.report.elements.comparisons import compare_modes
from rastrainer.study.outcomes import MAIN_OUTCOMES
from rastrainer.study.protocol.study_protocol import StudyProtocol
from rastrainer.study.study_data import read_study_data
from rastrainer_simulator.virtual.cohort import DATABASE, simulate_cohort
from rastrainer_simulator.virtual.play import PlaySettings
from rastrainer_simulator.virtual.population import ModeEffect, Population
from Testing.simulator.virtual.conftest import AIM_FACTOR, BRISK

TRAINEES = 20


@pytest.mark.soak
def test_the_effect_of_a_mode_is_found_where_it_is_and_of_its_size(tmp_path):
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


@pytest.mark.soak
def test_two_hundred_trainees_give_back_what_is_true_of_them(tmp_path):
    """An hour on two cores: ten tasks in both modes each, 4,000 trials."""
    tasks = tuple(f"task-{number}" for number in range(1, 6))
    modes = ("desktop", "hmd")
    protocol = StudyProtocol("soak", "Soak", modes, "balanced", tasks, "balanced", repetitions=2)
    effect = {"hmd": ModeEffect(speed=0.8, aim=1.5)}
    population = Population(skill=BRISK, learning=0.0, modes=effect)
    run = simulate_cohort(protocol, population, 200, 11, tmp_path / "study", PlaySettings())
    assert (run.played, run.stuck) == (4000, 0)
    data = read_study_data(tmp_path / "study" / DATABASE)
    found = {c.outcome.name: c for c in compare_modes(data, MAIN_OUTCOMES, *modes)}
    for name, factor in (("completion_time_s", 1 / 0.8), ("rmse_mm", 1.5)):
        desktop, hmd = map(np.mean, _means(found[name]))
        assert hmd / desktop == pytest.approx(factor, rel=0.05)
        assert found[name].adjusted_p < 1e-6


def _means(comparison):
    return comparison.first_means, comparison.second_means
