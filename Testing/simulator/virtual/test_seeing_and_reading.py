"""Tasks are completed by looking, not by reading alone; the figures are in `Testing/error_rates/tables.md`."""

from __future__ import annotations

import numpy as np
import pytest

from Testing.simulator.virtual.candidate_points import CENTER, CandidatePoints, surface_at
from Testing.simulator.virtual.played_models import MODELS, play

TASKS = ("trial-run", "task-1", "task-2", "task-3", "task-4", "task-5")
SEEDS = (11, 12, 13)
LEAST_GREEN, MOST_RED = 13, 1
"""Of 15 touches that are made by looking."""


def test_looking_alone_touches_exactly_in_the_trial_run(setup):
    looks = play(setup, "looks", "trial-run", 11, 10.0)
    assert looks.touches > 0
    assert looks.error_mm < 1.0


def test_distances_and_directions_alone_narrow_the_search_down_to_the_point():
    places, point = CandidatePoints(), surface_at(CENTER + np.array([0.03, -0.06, 0.06]))
    for start in ((0.0, -0.2, 0.1), (0.15, -0.1, 0.1), (0.0, -0.05, 0.2)):
        at = CENTER + np.array(start)
        places.is_away(at, float(np.linalg.norm(point - at)), np.sign(point - at))
    left = [place for place in places.all if places.may_be_at(place)]
    assert 0 < len(left) < 0.05 * len(places.all)
    assert min(np.linalg.norm(place - point) for place in left) < 0.006


def test_reading_alone_searches_new_places_and_revisits_none():
    places, at, seen = CandidatePoints(), CENTER + np.array([0.0, 0.0, 0.1]), []
    for _ in range(100):
        at = places.nearest(at)
        seen.append(at)
        places.is_not_at(at)
    assert len(np.unique(np.array(seen), axis=0)) == len(seen)
    steps = np.linalg.norm(np.diff(seen, axis=0), axis=1)
    assert np.median(steps) < 0.02


def test_a_reader_told_that_the_tip_is_off_the_path_looks_elsewhere():
    places = CandidatePoints()
    last = surface_at(CENTER + np.array([0.0, -0.1, 0.05]))
    places.has_touched(last, "2")
    beside = surface_at(CENTER + np.array([0.08, -0.02, 0.04]))
    assert places.may_be_at(beside)
    places.is_off_path(beside)
    assert not places.may_be_at(beside)
    assert places.may_be_at(surface_at(CENTER + np.array([-0.08, -0.02, 0.04])))


@pytest.mark.soak
@pytest.mark.parametrize("device", ["keys", "held keys", "pad", "touch screen", "mouse"])
def test_the_tip_lands_green_with_every_device(setup, device):
    looks = play(setup, "looks", "trial-run", 11, device=device)
    assert looks.touches == 15
    assert sum(landing.is_green for landing in looks.landings) >= LEAST_GREEN
    assert sum(landing.was_red for landing in looks.landings) <= MOST_RED


@pytest.mark.soak
@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("seed", SEEDS)
def test_looking_alone_finishes_every_task_and_reading_alone_does_worse(setup, task, seed):
    looks, reads = (play(setup, model, task, seed) for model in MODELS)
    assert looks.touches == 15
    assert looks.error_mm < 1.0
    assert reads.is_worse_than(looks)
    assert reads.touches > 0 or task != "trial-run"
