"""Sources of variation of a study's trials: practice, tempo, trainees, modes, and chance.

The logarithm of a positive outcome is regressed on ln(n) of the trial's number n over all modes, on
the tasks, and on one level for each trainee in each mode (least squares). The scatter of these
levels, less what chance adds to it, is parted into trainees and trainee × mode by the analysis of
variance with random effects (Searle, Casella and McCulloch 1992). No estimate is biased: the
coefficients are linear and the variances quadratic in the logarithms, with the parameters as their
expected values. A variance may come out below 0 where it is about 0.

The intervals take the scatter of levels and trials as normal and all trainees as learning alike.
"""

from __future__ import annotations

from dataclasses import dataclass

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

    Attributes:
        numbers: Which trial of the trainee's it was, over all modes, from 1.
        lapses: 1.0 if a touch was undone, else 0.0.
    """

    trainees: np.ndarray
    modes: np.ndarray
    tasks: np.ndarray
    numbers: np.ndarray
    lapses: np.ndarray


@dataclass(frozen=True)
class Variation:
    """The sources of variation of the logarithm of one outcome, with 95 % intervals.

    Attributes:
        learning: b; the n-th trial has n^−b of the first one's value.
        lapse: What an undone touch adds to the logarithm; None if there was none.
        modes: What each mode adds to the logarithm against the first mode, from the second on.
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
    columns.append(np.log(trials.numbers)[:, None])
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
    levels = _Levels(fitted[:count].reshape(trainees, modes), inverse[:count, :count], chance)
    return Variation(
        learning=-learning,
        lapse=lapse if has_lapses else None,
        modes=tuple(levels.of_mode(mode) for mode in range(1, modes)),
        trainee_variance=levels.trainee_variance(),
        interaction_variance=levels.interaction_variance(),
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


class _Levels:
    """The estimated levels of trainees in modes, and what their scatter says.

    Args:
        levels: (trainees, modes) float.
        inverse: What the variance between trials has to be multiplied by to get their covariance,
            row by row.
    """

    def __init__(self, levels: np.ndarray, inverse: np.ndarray, chance: MeanSquare) -> None:
        self._flat, self._inverse, self._chance = levels.ravel(), inverse, chance
        self._trainees, self._modes = levels.shape
        between = np.eye(self._trainees) - 1 / self._trainees
        of_modes = np.full((self._modes, self._modes), 1 / self._modes)
        # Of a mean over the modes, each square occurs that many times.
        self._between = self._square(np.kron(between, of_modes), self._trainees - 1)
        self._both = self._square(
            np.kron(between, np.eye(self._modes) - of_modes),
            (self._trainees - 1) * (self._modes - 1),
        )

    def interaction_variance(self) -> Estimate:
        """Return the variance between trainees × modes."""
        square, share = self._both
        return difference(square, self._scaled(share))

    def trainee_variance(self) -> Estimate:
        """Return the variance between trainees."""
        (between, of_between), (both, of_both) = self._between, self._both
        found = difference(between, both)
        # Chance adds nearly the same to both, or exactly so where the design is balanced.
        more = self._scaled(of_between - of_both).value
        low, high = ((limit - more) / self._modes for limit in found.interval)
        return Estimate((found.value - more) / self._modes, (low, high))

    def of_mode(self, mode: int) -> Estimate:
        """Return what a mode adds against the first.

        Its variance is that of a mean difference over the trainees, who differ in it by the
        interaction, and what the unknowns that all share add (Satterthwaite 1946).
        """
        contrast = np.zeros((self._trainees, self._modes))
        contrast[:, mode], contrast[:, 0] = 1 / self._trainees, -1 / self._trainees
        flat = contrast.ravel()
        square, share = self._both
        own = 2 / self._trainees * square.value
        more = float(flat @ self._inverse @ flat) - 2 / self._trainees * share
        shared = self._scaled(max(more, 0.0)).value
        dof = float(square.dof)
        if shared:
            dof = (own + shared) ** 2 / (own**2 / square.dof + shared**2 / self._chance.dof)
        return coefficient(float(flat @ self._flat), float(np.sqrt(own + shared)), dof)

    def _square(self, form: np.ndarray, dof: int) -> tuple[MeanSquare, float]:
        square = max(float(self._flat @ form @ self._flat), 0.0) / dof
        return MeanSquare(square, dof), float(np.sum(form * self._inverse)) / dof

    def _scaled(self, factor: float) -> MeanSquare:
        return MeanSquare(factor * self._chance.value, self._chance.dof)
