"""Tasks are done by who looks, not by who only reads; the figures are in docs/views.md."""

from __future__ import annotations

import pytest

from Testing.simulator.virtual.played_models import MODELS, play

TASKS = ("trial-run", "task-1", "task-2", "task-3", "task-4", "task-5")
SEEDS = (11, 12, 13)


def test_who_only_reads_finds_the_points_of_the_trial_run_but_worse_than_who_only_looks(setup):
    looks, reads = (play(setup, model, "trial-run", 12, 16.0) for model in MODELS)
    # It is a fair competitor: it knows where its tip is, and does not drift off the head.
    assert 0 < reads.touches < looks.touches
    assert looks.error_mm < 1.0


@pytest.mark.soak
@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize("seed", SEEDS)
def test_who_only_looks_finishes_every_task_and_who_only_reads_does_worse(setup, task, seed):
    looks, reads = (play(setup, model, task, seed) for model in MODELS)
    assert looks.touches == 15
    assert looks.error_mm < 1.0
    assert reads.is_worse_than(looks)
    assert reads.touches > 0 or task != "trial-run"
