"""A report's statements on drills: learning, training, mean d′, and the cause missed most."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.stats import norm, ttest_rel

from rastrainer.decision.drill_record import CASES, FAULTS
from rastrainer.decision.drill_score import (
    AGAIN_COST,
    CHECK_COST,
    HARM_COST,
    STOP_COST,
    VAIN_COST,
)
from rastrainer.number_text import counted
from rastrainer_simulator.statistics.intervals import ALPHA, mean
from rastrainer_simulator.statistics.paired import holm
from rastrainer_simulator.statistics.trend import cohort_trend_p
from Testing.error_rates.measured import Measured, holds, share_of, share_text

LEARNING_HEADER = ("five drills of each trainee", "said to get better", "without correction")
TRAINING_HEADER = (
    "a drill before and one after training",
    "said to differ",
    "without correction",
)
MEAN_HEADER = ("a drill of each trainee", "interval of the mean d′ contains the truth", "mean d′")
MISSED_HEADER = ("missed in 60 % against 25 %", "another cause is said to be missed most")
TRAINEES = (4, 10, 20)
SPREAD = 0.4
"""Standard deviation of d′ between trainees."""
CRITERION, CRITERION_SPREAD = 0.2, 0.2
STOPS, REPEATABLE, CHECKS = 0.3, 0.4, 2
"""Share of refusals that stop, and of faults that are repeatable; checks of each case."""
MISSED, MISSED_MOST = 0.25, 0.6


def learning(sets: int) -> Sequence[Measured]:
    """Return how often five drills are said to get better, by the gain in d′ over them."""
    found = []
    for gain in (0.0, 0.5, 1.0):
        random = np.random.default_rng([31, round(10 * gain)])
        for trainees in TRAINEES:
            # Most is learned at first.
            truths = 1.0 + gain * np.log(np.arange(1, 6)) / np.log(5)
            studies = zip(*drawn(random, sets, trainees, truths), strict=True)
            p = np.array([[cohort_trend_p(-d), cohort_trend_p(c)] for d, c in studies])
            found.append(_said(f"d′ gains {gain:g}, {trainees} trainees", p, gain))
    return found


def training(sets: int) -> Sequence[Measured]:
    """Return how often a drill after training is said to differ from one before it."""
    found = []
    for gain in (0.0, 0.5, 1.0):
        random = np.random.default_rng([32, round(10 * gain)])
        for trainees in TRAINEES:
            both = drawn(random, sets, trainees, np.array([1.0, 1.0 + gain]))
            # As `compare_paired`, for thousands of studies at once.
            p = [ttest_rel(each[..., 0], each[..., 1], axis=1).pvalue for each in both]
            found.append(_said(f"d′ gains {gain:g}, {trainees} trainees", np.column_stack(p), gain))
    return found


def _said(case: str, p: np.ndarray, gain: float) -> Measured:
    """Return how often the smaller of (n, 2) p is below the level, with and without correction."""
    said, alone = ((each < ALPHA).any(axis=1) for each in (holm(p), p))
    further = (share_text(share_of(alone)),)
    return Measured(case, share_of(said), len(p), None if gain else 0.06, further=further)


def means(sets: int) -> Sequence[Measured]:
    """Return how often the interval of the mean d′ holds the population's mean."""
    found = []
    for truth in (0.5, 1.0, 2.0):
        random = np.random.default_rng([33, round(10 * truth)])
        for trainees in TRAINEES:
            own = drawn(random, sets, trainees, np.array([truth]))[0][:, :, 0]
            share = share_of([holds(mean(study).interval, truth) for study in own])
            further = (f"{own.mean():.2f}",)
            case = f"d′ {truth:g}, {trainees} trainees"
            found.append(
                Measured(case, share, sets, at_least=None if truth > 1 else 0.92, further=further)
            )
    return found


def missed_most(sets: int) -> Sequence[Measured]:
    """Return how often a cause that is not missed most has the largest share."""
    random, found = np.random.default_rng(34), []
    for trainees, own in ((4, 5), (10, 1), (10, 5), (20, 1)):
        shares = np.full(len(FAULTS), MISSED)
        shares[0] = MISSED_MOST
        # Each cause is met once in a drill; chance decides between equal shares.
        missed = random.binomial(trainees * own, shares, (sets, len(FAULTS)))
        wrong = (missed + random.random(missed.shape)).argmax(axis=1) != 0
        case = f"{trainees} trainees, {counted(own, 'drill')} of each"
        asked = 0.1 if trainees * own >= 20 else None
        found.append(Measured(case, share_of(wrong), sets, asked))
    return found


def drawn(
    random: np.random.Generator, sets: int, trainees: int, truths: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return d′ and the cost of a case, (sets, trainees, drills) float, of drills with true d′."""
    shape = (sets, trainees, len(truths))
    own = truths + random.normal(0.0, SPREAD, (sets, trainees, 1))
    criterion = random.normal(CRITERION, CRITERION_SPREAD, (sets, trainees, 1))
    half = CASES // 2
    hits = random.binomial(half, norm.cdf(own / 2 - criterion), shape)
    alarms = random.binomial(half, norm.cdf(-own / 2 - criterion), shape)
    return sensitivity(hits, alarms), cost(hits, alarms, random)


def sensitivity(hits: np.ndarray, alarms: np.ndarray) -> np.ndarray:
    """Return d′ from the refusals over and within the limit, of half the cases each."""
    rates = (np.array([hits, alarms]) + 0.5) / (CASES // 2 + 1)
    hit_z, alarm_z = norm.ppf(rates)
    return hit_z - alarm_z


def cost(hits: np.ndarray, alarms: np.ndarray, random: np.random.Generator) -> np.ndarray:
    """Return a case's mean cost from the refusals over and within the limit."""
    stopped, stopped_right = random.binomial(alarms, STOPS), random.binomial(hits, STOPS)
    again = alarms + hits - stopped - stopped_right
    vain = alarms + random.binomial(hits - stopped_right, 1.0 - REPEATABLE)
    costs = AGAIN_COST * again + STOP_COST * (stopped + stopped_right) + VAIN_COST * vain
    return (costs + HARM_COST * (CASES // 2 - hits)) / CASES + CHECK_COST * CHECKS
