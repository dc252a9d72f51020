"""The same hands really play the same on all tasks, and the references of the tasks are fair."""

import numpy as np
import pytest
import scipy.stats

from rastrainer.trial.score_reference import fiducial_normals, region_of
from Testing.error_rates import hands
from Testing.error_rates.equal_hands import PlayedTask
from Testing.error_rates.hands import HEADS, SEEDS, SLOW, TASKS, USUAL, scenario_of, trials_of
from Testing.error_rates.registered import errors_along_skin, registered_errors

SETS = 300
PLACES = [(head, task) for head in HEADS for task in TASKS]


def errors_along(which, head, task):
    """Return the played errors along the skin, (trials, 15, 3) float, RAS mm."""
    normals = fiducial_normals(scenario_of(head), task)
    errors = np.array([one.errors_mm for one in trials_of(which, head, task)])
    return errors - normals * np.einsum("sij,ij->si", errors, normals)[..., None]


def test_the_reference_error_is_that_of_errors_along_the_skin():
    head, task = "egg", "task-5"
    scenario, random = scenario_of(head), np.random.default_rng(3)
    fiducials = np.asarray(scenario.task(task).fiducials, dtype=float)
    normals = fiducial_normals(scenario, task)
    touches = fiducials + errors_along_skin(normals, 1.0, 1500, random)
    errors = registered_errors(region_of(scenario), fiducials, touches)
    expected = region_of(scenario).tre_per_fle(fiducials, normals)
    assert np.sqrt(np.mean(errors**2)) == pytest.approx(expected, rel=0.05)


@pytest.mark.parametrize("which", [USUAL, pytest.param(SLOW, marks=pytest.mark.soak)])
def test_assembled_trials_score_like_played_ones(which):
    off = []
    for number, place in enumerate(PLACES):
        task = PlayedTask(*place, trials_of(which, *place))
        assemble = task.assemble(task.touches, SETS, np.random.default_rng(number))
        played = task.scores(task.played())
        error = played.std(ddof=1) / np.sqrt(len(played))
        off.append((played.mean() - task.scores(assemble).mean()) / error)
    assert abs(np.mean(off)) < 3.3 / np.sqrt(len(off))


@pytest.mark.parametrize("which", [USUAL, SLOW])
def test_the_touches_are_independent_and_equally_accurate_on_all_tasks(which):
    """Otherwise the errors of all tasks could not stand for the errors of one."""
    found = [errors_along(which, *place) for place in PLACES]
    errors = np.concatenate(found)
    products = np.einsum("sij,sij->si", errors[:, 1:], errors[:, :-1])
    assert abs(products.mean()) < 3.3 * products.std() / np.sqrt(products.size)
    assert (np.abs(errors.mean(axis=(0, 1))) < 0.1).all()
    squares = [np.sum(each**2, axis=2) for each in found]
    assert scipy.stats.f_oneway(*(each.mean(axis=1) for each in squares)).pvalue > 0.001


def assert_is_as_stored(key):
    """Compare with tolerances: other versions of the libraries round differently."""
    kept, again = hands.stored()[key], hands.play(*key)
    assert again.time_s == pytest.approx(kept.time_s, rel=0.1)
    assert np.sqrt(np.mean((again.errors_mm - kept.errors_mm) ** 2)) < 0.3
    assert again.safety[2] == pytest.approx(kept.safety[2], abs=0.15)


def test_typical_hands_reproduce_a_stored_trial():
    assert_is_as_stored((USUAL, 1, HEADS[0], "task-1"))


@pytest.mark.soak
@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("head", HEADS)
@pytest.mark.parametrize("which", [USUAL, SLOW])
def test_hands_reproduce_the_first_and_the_last_stored_trial(which, head, task):
    for seed in (SEEDS[which][0], SEEDS[which][-1]):
        assert_is_as_stored((which, seed, head, task))
