"""Estimates of the variation of trials are unbiased, and omitted where trials do not allow them.

How often the intervals contain the truth is among the error rates.
"""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer_simulator.report.variation import study_variation, variation
from rastrainer_simulator.statistics.variation import Trials, fit_variation
from Testing.error_rates.recovery import MODEL, PROTOCOL, draw_protocol_study


def drawn(trainees=12, seed=1, protocol=PROTOCOL, **changes):
    random = np.random.default_rng(seed)
    return draw_protocol_study(replace(MODEL, **changes), protocol, trainees, random)


class Noiseless(np.random.Generator):
    """Draws lapses, and the expected value of everything else."""

    def __init__(self, seed):
        super().__init__(np.random.PCG64(seed))

    def normal(self, loc=0.0, scale=1.0, size=None):
        return np.zeros(() if size is None else size) + loc + 0.0 * np.max(scale)

    def chisquare(self, df, size=None):
        return np.full(() if size is None else size, float(df))


def trials_of(study):
    """Return the trials of a study as the report numbers them, and the times and errors."""
    rows = sorted(study.trials, key=lambda row: row.trainee)
    places = [sorted({getattr(row, name) for row in rows}) for name in ("trainee", "mode", "task")]
    columns = [
        np.array([names.index(getattr(row, name)) for row in rows])
        for names, name in zip(places, ("trainee", "mode", "task"), strict=True)
    ]
    numbers = np.tile(np.arange(1, len(rows) // len(places[0]) + 1), len(places[0]))
    lapses = np.array([float(row.values["undone_touches"] > 0) for row in rows])
    return Trials(*columns, numbers, lapses)


def test_without_noise_every_coefficient_is_exact_for_time_and_error():
    """They are linear in the logarithms: exact without noise is unbiased with it."""
    study = draw_protocol_study(replace(MODEL, trade_off=0.0), PROTOCOL, 12, Noiseless(1))
    found = study_variation(study)
    for one, learning, mode, lapse in (
        (found.time, MODEL.learning, MODEL.mode_time["hmd"], MODEL.lapse_time),
        (found.error, MODEL.accuracy_learning, MODEL.mode_fle["hmd"], 1.0),
    ):
        assert one.learning.value == pytest.approx(learning, abs=1e-12)
        assert one.lapse.value == pytest.approx(np.log(lapse), abs=1e-12)
        assert [mode_.value for mode_ in one.modes] == pytest.approx([np.log(mode)], abs=1e-12)
        variances = one.trainee_variance, one.interaction_variance, one.trial_variance
        assert [square.value for square in variances] == pytest.approx([0, 0, 0], abs=1e-12)


@pytest.mark.parametrize("source", ["trainee_variance", "interaction_variance", "trial_variance"])
def test_the_expected_value_of_each_variance_is_the_variance(source):
    """They are quadratic forms yᵀAy: with Cov(y) = L Lᵀ, E[yᵀAy] = tr(A L Lᵀ) = Σⱼ lⱼᵀAlⱼ."""
    trainees = 4
    trials = trials_of(drawn(trainees=trainees))
    cells = trials.trainees * 2 + trials.modes
    roots = {
        "trainee_variance": 0.3 * np.eye(trainees)[trials.trainees],
        "interaction_variance": 0.2 * np.eye(2 * trainees)[cells],
        "trial_variance": 0.1 * np.eye(len(cells)),
    }
    columns = np.hstack(list(roots.values()))
    squares = [getattr(fit_variation(trials, np.exp(column)), source).value for column in columns.T]
    # The other sources add nothing.
    assert np.sum(squares) == pytest.approx(roots[source].max() ** 2, abs=1e-10)


@pytest.mark.parametrize(
    "study",
    [
        drawn(trainees=3),
        drawn(protocol=replace(PROTOCOL, modes=("hmd",))),
        replace(drawn(), has_order=False),
        replace(drawn(), trials=drawn().trials[::7]),
    ],
    ids=["three trainees", "one mode", "no order", "hardly any trials"],
)
def test_estimates_that_the_trials_do_not_allow_are_omitted(study):
    assert study_variation(study) is None
    assert "Practice: exponent b" not in variation(study)
