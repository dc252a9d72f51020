"""Tasks are done by who looks, not by who only reads; the figures are in docs/views.md."""

from __future__ import annotations

import pytest

from Testing.simulator.virtual.played_models import MODELS, play

WITHOUT_WORDS = ("task-1", "task-2", "task-3", "task-4", "task-5")
SEEDS = (11, 12, 13)


def test_who_only_looks_touches_exactly_in_the_trial_run(setup):
    looks = play(setup, "looks", "trial-run", 11, 10.0)
    assert looks.touches > 0
    assert looks.error_mm < 1.0


def test_without_words_who_looks_touches_exactly_while_who_only_reads_searches(setup):
    looks, reads = (play(setup, model, "task-4", 11, 10.0) for model in MODELS)
    assert looks.touches > reads.touches
    assert looks.error_mm < 1.0


@pytest.mark.soak
@pytest.mark.parametrize("seed", SEEDS)
def test_who_only_looks_finishes_the_trial_run(setup, seed):
    looks = play(setup, "looks", "trial-run", seed)
    assert looks.touches == 15
    assert looks.error_mm < 1.0


@pytest.mark.soak
@pytest.mark.parametrize("task", WITHOUT_WORDS)
@pytest.mark.parametrize("seed", SEEDS)
def test_who_only_looks_finishes_every_task_and_who_only_reads_does_worse(setup, task, seed):
    looks, reads = (play(setup, model, task, seed) for model in MODELS)
    assert looks.touches == 15
    assert looks.error_mm < 1.0
    assert reads.is_worse_than(looks)
