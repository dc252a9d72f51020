"""Motion metrics and score tell honest play from each way to cheat."""

import functools

import numpy as np
import pytest

from rastrainer.protocol import TouchRule
from rastrainer.trial.scoring import PASS_MARK, passes
from Testing.error_rates.played import score_of
from Testing.simulator.virtual.cheating_trainees import CHEATS

TASKS = ("task-1", "task-5")
SEED = 3


@pytest.fixture(scope="module", params=[TASKS[0], pytest.param(TASKS[1], marks=pytest.mark.soak)])
def task(request):
    return request.param


@pytest.fixture(scope="module")
def cheat(setup, task):
    """A function that plays the task in one of the ways to cheat, each only once."""
    return functools.cache(lambda name: CHEATS[name](setup, task, SEED))


def touch_errors(played):
    """Return how far each touch is from its fiducial, (15, 3) float, World, mm."""
    record, truth = played.record, played.truth
    fiducials = [truth.in_world(truth.fiducials_ras[label]) for label in record.labels]
    return record.positions_mm - np.array(fiducials)


def test_dragging_from_fiducial_to_fiducial_counts_as_unintended_contact_nearly_all_the_way(cheat):
    motion = cheat("drag").record.motion
    # Five millimeters about each touch belong to it: ten on each of fourteen paths.
    expected_mm = motion["path_between_touches_mm"] - 14 * 10.0
    assert motion["unintended_contact_path_mm"] > 0.8 * expected_mm
    assert motion["unintended_contact_time_s"] > 0.4 * motion["completion_time_s"]


def test_pressing_in_two_millimeters_at_each_touch_is_measured_as_two_millimeters(cheat):
    played = cheat("press")
    assert played.record.motion["pressing_depth_mm"] == pytest.approx(2.0, abs=0.05)
    assert played.record.motion["unintended_contact_time_s"] == 0.0
    assert np.linalg.norm(touch_errors(played), axis=1).max() < 0.5


def test_hovering_makes_no_contact_and_gives_all_touches_the_same_error(cheat):
    played = cheat("hover")
    motion, errors = played.record.motion, touch_errors(played)
    assert played.record.touch_rule == TouchRule.WITHIN_RADIUS.value
    assert motion["contacts"] == motion["pressing_depth_mm"] == 0.0
    assert np.linalg.norm(errors, axis=1) == pytest.approx(np.full(15, 9.0), abs=0.05)
    assert np.ptp(errors, axis=0).max() < 0.05


@pytest.mark.parametrize("name", CHEATS)
def test_no_cheat_scores_more_than_40_points_or_passes(setup, cheat, name):
    score = score_of(setup, cheat(name))
    assert score.score <= 40.0
    assert not passes(score.score, score.acceptable, PASS_MARK)
