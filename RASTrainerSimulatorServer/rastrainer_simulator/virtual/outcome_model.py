"""A model of the outcomes of trials, without the physics: thousands of studies in a second.

Completion time and registration error of a trial are drawn from the distributions that the theory
gives: times log-normal about task, trainee, mode and practice; errors as the FRE of fifteen points
whose localization error depends on task, trainee and mode (FRE² = FLE²·(1 − 2/N)·χ²/dof).
Estimates from such data can be compared with the true values. It is not the simulator: hands, arm
and head play no part.

Practice is the power law (Newell and Rosenbloom 1981); a hurried trial is the less exact one, as
where errors are in proportion to the speed (Schmidt et al. 1979: exponent 1); a view that misleads
all touches alike leaves the registration's residuals as they are, and moves the target.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
import scipy

from rastrainer.protocol import FIDUCIAL_COUNT
from rastrainer.trial.scoring import ScoreMeasures, ScoreReference, score_trial
from rastrainer_simulator.report.comparisons import CONFIRMATORY
from rastrainer_simulator.statistics.intervals import ALPHA
from rastrainer_simulator.statistics.paired import fit_differences, holm, is_separable, rank_test

DOF = 3 * FIDUCIAL_COUNT - 6
REFERENCE_RMSE_MM, REFERENCE_TRE_MM = 1.4, 0.4
"""The published study's mean RMSE over fifteen fiducials, and the mean error at their center."""
REFERENCE_COMMON_BIAS_MM = 0.6
"""Common bias that touches with this scatter seem to have on the tasks of Colin27, RMS."""


@dataclass(frozen=True)
class OutcomeModel:
    """The truth of a simulated study.

    Attributes:
        task_times_s: Median completion time of each task at the first trial in the first mode.
        interaction_sd: How differently modes affect trainees; like the other deviations, of the
            logarithms.
        learning: b; the n-th trial takes n^−b of the first one's time.
        carries_practice: Whether n counts the trials of both modes, as for the virtual trainees
            that are played; otherwise each mode starts from 1.
        trade_off: k; a trial that takes x times as long as the trainee's others of its kind has a
            localization error x^−k times as large.
        lapses: Share of trials in which a touch slips, is noticed and taken back.
        mode_bias_mm: By how many mm the view of a mode misleads all touches alike; 0 for those left
            out.
    """

    task_times_s: Sequence[float]
    task_fle_mm: Sequence[float]
    trainee_time_sd: float = 0.15
    trainee_fle_sd: float = 0.15
    interaction_sd: float = 0.05
    trial_time_sd: float = 0.12
    learning: float = 0.1
    carries_practice: bool = False
    mode_time: Mapping[str, float] = field(default_factory=dict)
    mode_fle: Mapping[str, float] = field(default_factory=dict)
    accuracy_learning: float = 0.0
    trade_off: float = 0.0
    lapses: float = 0.0
    lapse_time: float = 1.05
    mode_bias_mm: Mapping[str, float] = field(default_factory=dict)


def trial_numbers(orders: Sequence[Sequence[str]], modes: Sequence[str], tasks: int) -> np.ndarray:
    """Return the number of each trial if all tasks are done in turn, mode by mode.

    The array is (trainees, modes, tasks) int, from 1.
    """
    periods = np.array([[own.index(mode) for mode in modes] for own in orders])
    return periods[..., None] * tasks + np.arange(1, tasks + 1)


def draw(
    model: OutcomeModel, modes: Sequence[str], random: np.random.Generator, numbers: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return times in s, RMSE and localization errors in mm, and lapses, all as `numbers`.

    `numbers` are (trainees, modes, tasks) int, which trial of the trainee's each is, from 1.
    """
    shape = numbers.shape
    own_time, own_fle = (
        random.normal(0, sd, (shape[0], 1, 1))
        + random.normal(0, model.interaction_sd, (shape[0], shape[1], 1))
        for sd in (model.trainee_time_sd, model.trainee_fle_sd)
    )
    median_times, median_fle = _medians(model, modes)
    practice, accuracy = _practice(model, numbers)
    haste = random.normal(0, model.trial_time_sd, shape)
    times = median_times * practice * np.exp(own_time + haste)
    fle = median_fle * accuracy * np.exp(own_fle - model.trade_off * haste)
    # The expected FRE² is FLE²·(1 − 2/N), and 3N − 6 residuals are left after a rigid fit.
    squares = fle**2 * (1 - 2 / FIDUCIAL_COUNT) * random.chisquare(DOF, shape) / DOF
    lapses = random.random(shape) < model.lapses if model.lapses else np.zeros(shape, dtype=bool)
    return times * np.where(lapses, model.lapse_time, 1.0), np.sqrt(squares), fle, lapses


def model_scores(model: OutcomeModel, times_s: np.ndarray, errors_mm: np.ndarray) -> np.ndarray:
    """Return the scores of drawn trials, in their shape (…, tasks).

    The target error and the common bias are what the registration error means on average; no one
    touches the head but at the fiducials; the reference of a task is its own time.
    """
    scores = np.empty(times_s.shape)
    for index in np.ndindex(times_s.shape):
        size = float(errors_mm[index] / REFERENCE_RMSE_MM)
        tre_mm, bias_mm = REFERENCE_TRE_MM * size, REFERENCE_COMMON_BIAS_MM * size
        measures = ScoreMeasures(float(times_s[index]), tre_mm, 0.0, 0.0, 0.0, bias_mm)
        reference = ScoreReference(model.task_times_s[index[-1]], REFERENCE_TRE_MM)
        scores[index] = score_trial(measures, reference).score
    return scores


def expected_outcomes(model: OutcomeModel, modes: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return the means that very many trainees have: times in s and RMSE in mm, (modes, tasks).

    Where practice is carried over, they are the means over all periods: what modes do apart from
    their order. A log-normal's mean is exp(σ²/2) times its median; χ has the mean √2·Γ((k +
    1)/2)/Γ(k/2).
    """
    times, fle = _medians(model, modes)
    # Each mode in each period; modes in the second axis make no difference here.
    numbers = trial_numbers([tuple(modes)], modes, len(model.task_times_s))[0]
    practice, accuracy = (factor.mean(axis=0) for factor in _practice(model, numbers))
    time_sds = (model.trainee_time_sd, model.interaction_sd, model.trial_time_sd)
    fle_sds = (model.trainee_fle_sd, model.interaction_sd, model.trade_off * model.trial_time_sd)
    of_time, of_fle = (math.exp(sum(sd**2 for sd in sds) / 2) for sds in (time_sds, fle_sds))
    of_time *= 1 + model.lapses * (model.lapse_time - 1)
    chi = math.sqrt(2) * math.exp(math.lgamma((DOF + 1) / 2) - math.lgamma(DOF / 2))
    residual = math.sqrt((1 - 2 / FIDUCIAL_COUNT) / DOF) * chi
    return times * practice * of_time, fle * accuracy * of_fle * residual


def _medians(model: OutcomeModel, modes: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return time in s and localization error in mm of the typical trainee, (modes, tasks).

    The time is without practice.
    """
    mode_time, mode_fle = (
        np.array([factors.get(mode, 1.0) for mode in modes])[:, None]
        for factors in (model.mode_time, model.mode_fle)
    )
    times = mode_time * np.asarray(model.task_times_s)
    return times, mode_fle * np.asarray(model.task_fle_mm)


def _practice(model: OutcomeModel, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the factors of practice on time and localization error of such trials (…, tasks)."""
    if not model.carries_practice:
        # A trial's number within its mode.
        numbers = numbers.argsort(axis=-1).argsort(axis=-1) + 1
    return numbers ** -float(model.learning), numbers ** -float(model.accuracy_learning)


@dataclass(frozen=True)
class RejectionRates:
    """Rates for one outcome over many studies: false positives without an effect, else power.

    Shares of p < .05 by the t-test (with the period where the orders allow it), by Holm's
    correction for all outcomes, and by the rank test; the share of 95 % intervals that cover the
    true difference, and this difference, second mode minus first, of the means of very many
    trainees. The last two are None for the score, whose true difference is not in the model.
    """

    outcome: str
    t_test: float
    holm: float
    ranks: float
    coverage: float | None
    true_difference: float | None


def rejection_rates(
    model: OutcomeModel,
    trainees: int,
    modes: Sequence[str],
    studies: int,
    seed: int,
    orders: Sequence[Sequence[str]] | None = None,
) -> tuple[RejectionRates, ...]:
    """Return the rates for two modes, tested on trainee means as the report does it.

    `orders` are the modes in the order of each trainee; by default all follow `modes`.
    """
    random = np.random.default_rng(seed)
    orders = orders or [tuple(modes)] * trainees
    numbers = trial_numbers(orders, modes, len(model.task_times_s))
    drawn = [draw(model, modes, random, numbers)[:2] for _ in range(studies)]
    times, errors = (np.array(values) for values in zip(*drawn, strict=True))
    outcomes = (times, errors, model_scores(model, times, errors))
    # Periods between the modes of each trainee.
    periods = np.array([float(own.index(modes[1]) - own.index(modes[0])) for own in orders])
    delays = periods if is_separable(periods) else None
    differences = [np.diff(values.mean(axis=-1))[..., 0] for values in outcomes]
    fits = [fit_differences(own, delays) for own in differences]
    students = scipy.stats.t
    p_values = np.stack(
        [2 * students.sf(np.abs(fit.mean / fit.standard_error), fit.dof) for fit in fits], axis=-1
    )
    adjusted = holm(p_values)
    truths = [means.mean(axis=1) for means in expected_outcomes(model, modes)]
    found = []
    for index, outcome in enumerate(CONFIRMATORY):
        fit, truth, coverage = fits[index], None, None
        if index < len(truths):
            truth = float(truths[index][1] - truths[index][0])
            reach = students.ppf(1 - ALPHA / 2, fit.dof) * fit.standard_error
            coverage = float(np.mean(np.abs(fit.mean - truth) <= reach))
        tests = [rank_test(row, delays) for row in differences[index]]
        # What cannot be tested is never rejected.
        ranks = np.mean([test is not None and test.p < ALPHA for test in tests])
        t_test, corrected = (np.mean(p[:, index] < ALPHA) for p in (p_values, adjusted))
        shares = float(t_test), float(corrected), float(ranks)
        found.append(RejectionRates(outcome, *shares, coverage, truth))
    return tuple(found)
