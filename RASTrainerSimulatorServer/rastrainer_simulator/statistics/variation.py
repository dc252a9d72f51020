"""Sources of variation of a study's trials: practice, tempo, trainees, modes, and chance.

The logarithm of a positive outcome is regressed on ln(n) of the trial's number n over all modes, on
the tasks, and on one level for each trainee in each mode (least squares). The scatter of these
levels, less what chance adds to it, is parted into trainees and trainee × mode by the analysis of
variance with random effects (Searle, Casella and McCulloch 1992). No estimate is biased: the
coefficients are linear and the variances quadratic in the logarithms, with the parameters as their
expected values. The estimate of a variance of about 0 may be below 0.

The intervals take the scatter of levels and trials as normal and all trainees as learning alike.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from rastrainer_simulator.statistics.intervals import (
    Estimate,
    MeanSquare,
    coefficient,
    difference,
    variance,
)

MIN_TRAINEES = 4


@dataclass(frozen=True)
class Trials:
    """The trials of a study in which every trainee did every mode; all arrays are (n,).

    They are numbered over all modes, from 1; a lapse is 1.0 if a touch was undone, else 0.0.
    """

    trainees: np.ndarray
    modes: np.ndarray
    tasks: np.ndarray
    numbers: np.ndarray
    lapses: np.ndarray


@dataclass(frozen=True)
class Variation:
    """The sources of variation of the logarithm of one outcome, with 95 % intervals.

    The learning exponent is b: the n-th trial has n^−b of the first trial's value. An undone touch
    adds `lapse` to the logarithm (None without any), and each mode after the first adds its own.
    """

    learning: Estimate
    lapse: Estimate | None
    modes: tuple[Estimate, ...]
    trainee_variance: Estimate
    interaction_variance: Estimate
    trial_variance: Estimate
    dof: int
    residuals: np.ndarray


def fit_variation(trials: Trials, values: np.ndarray) -> Variation | None:
    """Return what positive values (n,) vary by; None if the trials do not allow it.

    They do not where there are fewer than four trainees or two modes, where a trainee lacks a mode,
    or where there are no more trials than unknowns.
    """
    trainees, modes = int(trials.trainees.max()) + 1, int(trials.modes.max()) + 1
    cells = trials.trainees * modes + trials.modes
    if trainees < MIN_TRAINEES or modes < 2 or len(np.unique(cells)) < trainees * modes:
        return None
    columns = [np.eye(trainees * modes)[cells], np.eye(int(trials.tasks.max()) + 1)[trials.tasks]]
    columns[1] = columns[1][:, 1:]
    columns.append(-np.log(trials.numbers)[:, None])
    has_lapses = np.ptp(trials.lapses) > 0
    if has_lapses:
        columns.append(trials.lapses[:, None])
    design = np.hstack(columns)
    dof = len(values) - design.shape[1]
    if dof < 1 or np.linalg.matrix_rank(design) < design.shape[1]:
        return None
    y = np.log(values)
    inverse = np.linalg.inv(design.T @ design)
    fitted = inverse @ (design.T @ y)
    residuals = y - design @ fitted
    chance = MeanSquare(float(residuals @ residuals) / dof, dof)
    place = design.shape[1] - 1 - has_lapses
    learning, lapse = (
        coefficient(float(fitted[at]), float(np.sqrt(chance.value * inverse[at, at])), dof)
        for at in (place, -1)
    )
    count = trainees * modes
    between, both, modes_added = _compare_levels(
        fitted[:count].reshape(trainees, modes), inverse[:count, :count], chance
    )
    return Variation(
        learning=learning,
        lapse=lapse if has_lapses else None,
        modes=modes_added,
        trainee_variance=between,
        interaction_variance=both,
        trial_variance=variance(chance),
        dof=dof,
        residuals=residuals,
    )


def trade_off(times: Variation, errors: Variation) -> Estimate:
    """Return k: a trial x times as long as usual has an error x^−k as large.

    "As usual" is what practice, task, trainee and mode say of both.
    """
    haste, errors_left = times.residuals, errors.residuals
    squares = float(haste @ haste)
    slope = float(haste @ errors_left) / squares
    left = errors_left - slope * haste
    dof = errors.dof - 1
    return coefficient(-slope, float(np.sqrt(left @ left / dof / squares)), dof)


def _compare_levels(
    levels: np.ndarray, inverse: np.ndarray, chance: MeanSquare
) -> tuple[Estimate, Estimate, tuple[Estimate, ...]]:
    """Return the variances between trainees and trainees × modes, and what each mode adds.

    `levels` are (trainees, modes) float, as estimated; their covariance, row by row, is `inverse`
    times the variance between trials.
    """
    flat, (trainees, modes) = levels.ravel(), levels.shape

    def square_of(form: np.ndarray, dof: int) -> tuple[MeanSquare, float]:
        """Return a mean square of the levels, and how many variances between trials it has."""
        value = max(float(flat @ form @ flat), 0.0) / dof
        return MeanSquare(value, dof), float(np.sum(form * inverse)) / dof

    apart, means = np.eye(trainees) - 1 / trainees, np.full((modes, modes), 1 / modes)
    between, of_between = square_of(np.kron(apart, means), trainees - 1)
    both, of_both = square_of(np.kron(apart, np.eye(modes) - means), (trainees - 1) * (modes - 1))
    interaction = difference(both, replace(chance, value=of_both * chance.value))
    found = difference(between, both)
    # Chance adds nearly the same to both, or exactly so where the design is balanced; and each
    # square occurs once for each mode in a mean over the modes.
    more = (of_between - of_both) * chance.value
    low, high = ((limit - more) / modes for limit in found.interval)
    trainee = Estimate((found.value - more) / modes, (low, high))
    added = []
    for mode in range(1, modes):
        contrast = np.zeros((trainees, modes))
        contrast[:, mode], contrast[:, 0] = 1 / trainees, -1 / trainees
        weights = contrast.ravel()
        # The variance of a mean difference over the trainees, who differ in it by the interaction,
        # and what the unknowns that all share add (Satterthwaite 1946).
        own = 2 / trainees * both.value
        extra = float(weights @ inverse @ weights) - 2 / trainees * of_both
        shared = max(extra, 0.0) * chance.value
        dof = float(both.dof)
        if shared:
            dof = (own + shared) ** 2 / (own**2 / both.dof + shared**2 / chance.dof)
        added.append(coefficient(float(weights @ flat), float(np.sqrt(own + shared)), dof))
    return trainee, interaction, tuple(added)
