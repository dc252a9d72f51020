"""Tasks are completed by looking alone; the figures are in docs/views.md."""

from __future__ import annotations

import pytest

from Testing.simulator.virtual.played_models import play

TASKS = ("trial-run", "task-1", "task-2", "task-3", "task-4", "task-5")
SEEDS = (11, 12, 13)
LEAST_GREEN, MOST_RED = 13, 1
"""Of 15 touches that are made by looking."""


def test_looking_alone_touches_exactly_in_the_trial_run(setup):
    looks = play(setup, "trial-run", 11, 8.0)
    assert looks.touches > 0
    assert looks.error_mm < 1.0


@pytest.mark.soak
@pytest.mark.parametrize("device", ["keys", "held keys", "pad", "touch screen", "mouse"])
def test_the_tip_lands_green_with_every_device(setup, device):
    looks = play(setup, "trial-run", 11, device=device)
    assert looks.touches == 15
    assert sum(landing.is_green for landing in looks.landings) >= LEAST_GREEN
    assert sum(landing.was_red for landing in looks.landings) <= MOST_RED


@pytest.mark.soak
@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("seed", SEEDS)
def test_looking_alone_finishes_every_task(setup, task, seed):
    looks = play(setup, task, seed)
    assert looks.touches == 15
    assert looks.error_mm < 1.0
