"""Estimates of the variation of trials are unbiased, and reported with their intervals.

How often the intervals contain the truth is among the error rates.
"""

from dataclasses import replace

import numpy as np
import pytest

from rastrainer_simulator.report.variation import study_variation, variation, view_bias
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


@pytest.mark.parametrize("trainees", [4, 12])
@pytest.mark.parametrize("source", ["trainee_variance", "interaction_variance", "trial_variance"])
def test_the_expected_value_of_each_variance_is_the_variance(source, trainees):
    """They are quadratic forms yᵀAy: with Cov(y) = L Lᵀ, E[yᵀAy] = tr(A L Lᵀ) = Σⱼ lⱼᵀAlⱼ."""
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


def test_the_expected_bias_of_a_view_is_the_bias():
    """It is of second order: what takes two values ±σ has the expected value of a normal variable.

    All eight combinations of the three axes are drawn once.
    """
    study, squared_fle, bias = drawn(trainees=4), 1.5**2, 0.8
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1).T
    rows = [row for row in study.trials if row.mode == "hmd"][:16]
    rows = [replace(row, trainee=f"T{number % 4}") for number, row in enumerate(rows)]
    scatter, assumed = squared_fle / 15, 3 * 0.25**2
    trials = []
    for row, sign in zip(rows, np.repeat(signs, 2, axis=0), strict=True):
        offset = sign * np.sqrt(scatter / 3) + [bias, 0.0, 0.0]
        values = {
            "true_tre_mm": float(np.linalg.norm(offset)),
            "expected_tre_mm": float(np.sqrt(scatter + assumed)),
            "tre_common_bias_sd_mm": 0.25,
        }
        trials.append(replace(row, values=values))
    found = view_bias(replace(study, trials=tuple(trials)), "hmd")
    assert (found.trainees, found.trials) == (4, 16)
    assert found.squared.value == pytest.approx(bias**2, abs=1e-12)
    assert view_bias(replace(study, trials=tuple(trials[::4])), "hmd") is None


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


def test_trainees_without_all_modes_are_left_out():
    whole = drawn()
    lacking = tuple(t for t in whole.trials if (t.trainee, t.mode) != ("V0001", "hmd"))
    without = tuple(t for t in whole.trials if t.trainee != "V0001")
    found, expected = (
        study_variation(replace(whole, trials=trials)) for trials in (lacking, without)
    )
    assert found.trainees == 11
    assert found.time.learning == expected.time.learning


def test_the_report_has_a_table_of_variation_with_n():
    page = variation(drawn())
    assert "What completion time and error vary with" in page
    assert "120 trials of the 12 trainees who did every mode" in page
    assert "Trainee × mode (SD)" in page
    assert "Headset (HMD) against Desktop" in page
    found = study_variation(drawn())
    assert f"{found.time.learning.value:.3f} [" in page
    assert "displacement of the target, mm [95 %]" in page
