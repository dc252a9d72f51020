"""What the trials of a study vary by: practice, tempo, trainees, modes, and chance.

The logarithm of a positive outcome is regressed on ln(n) of the trial's number n over all modes, on
the tasks, and on one level for each trainee in each mode (least squares). The scatter of these
levels, less what chance adds to it, is parted into trainees and trainee × mode by the analysis of
variance with random effects (Searle, Casella and McCulloch 1992). No estimate is biased;
a variance may come out below 0 where it is about 0.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

MIN_TRAINEES = 4


@dataclass(frozen=True)
class Trials:
    """The trials of a study in which every trainee did every mode; all arrays are (n,).

    Attributes:
        trainees: Index of the trainee, from 0.
        modes: Index of the mode, from 0.
        tasks: Index of the task, from 0.
        numbers: Which trial of the trainee's it was, over all modes, from 1.
        lapses: 1.0 where a touch was taken back, else 0.0.
    """

    trainees: np.ndarray
    modes: np.ndarray
    tasks: np.ndarray
    numbers: np.ndarray
    lapses: np.ndarray


@dataclass(frozen=True)
class Variation:
    """What the logarithm of one outcome varies by.

    Attributes:
        learning: b; the n-th trial has n^−b of the first one's value.
        learning_error: Standard error of b.
        lapse: What a touch taken back adds to the logarithm; None where there was none.
        modes: (m,) float, what each mode adds to the logarithm against the first mode.
        trainee_variance: Between trainees, over the modes.
        interaction_variance: Between trainees × modes.
        trial_variance: Between trials of a trainee in a mode.
        dof: Of `trial_variance`.
        residuals: (n,) float, of the trials.
    """

    learning: float
    learning_error: float
    lapse: float | None
    modes: np.ndarray
    trainee_variance: float
    interaction_variance: float
    trial_variance: float
    dof: int
    residuals: np.ndarray


def fit_variation(trials: Trials, values: np.ndarray) -> Variation | None:
    """Return what positive values (n,) vary by; None where the trials do not allow it.

    They do not where there are fewer than four trainees or two modes, where somebody lacks a mode,
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
    variance = float(residuals @ residuals) / dof
    count = trainees * modes
    of_trainees, of_both = _components(
        fitted[:count].reshape(trainees, modes), variance * inverse[:count, :count]
    )
    place = design.shape[1] - 1 - has_lapses
    levels = fitted[:count].reshape(trainees, modes).mean(axis=0)
    return Variation(
        learning=-float(fitted[place]),
        learning_error=float(np.sqrt(variance * inverse[place, place])),
        lapse=float(fitted[-1]) if has_lapses else None,
        modes=levels - levels[0],
        trainee_variance=of_trainees,
        interaction_variance=of_both,
        trial_variance=variance,
        dof=dof,
        residuals=residuals,
    )


def trade_off(times: Variation, errors: Variation) -> tuple[float, float]:
    """Return k and its standard error: a trial x times as long as usual has an error x^−k as large.

    "As usual" is what practice, task, trainee and mode say of both.
    """
    haste, errors_left = times.residuals, errors.residuals
    squares = float(haste @ haste)
    slope = float(haste @ errors_left) / squares
    left = errors_left - slope * haste
    return -slope, float(np.sqrt(left @ left / (errors.dof - 1) / squares))


def _components(levels: np.ndarray, chance: np.ndarray) -> tuple[float, float]:
    """Return the variances between trainees and between trainees × modes.

    Args:
        levels: (trainees, modes) float, as they were estimated.
        chance: Covariance of what chance adds to them, row by row.
    """
    trainees, modes = levels.shape
    of_trainees = np.eye(trainees) - 1 / trainees
    of_modes = np.eye(modes) - 1 / modes
    both = np.kron(of_trainees, of_modes)
    means = np.kron(of_trainees, np.full((modes, modes), 1 / modes))
    flat = levels.ravel()
    dof = (trainees - 1) * (modes - 1)
    interaction = (flat @ both @ flat - np.trace(both @ chance)) / dof
    # Of a mean over the modes, each square stands there so many times.
    between = (flat @ means @ flat - np.trace(means @ chance)) / (trainees - 1)
    return float((between - interaction) / modes), float(interaction)
