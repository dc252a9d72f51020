"""Groups of trainees: how often one population is split, and which groups are found."""

from __future__ import annotations

import contextlib

import numpy as np

from rastrainer_simulator.statistics.trainee_clusters import (
    ALPHA,
    MIN_TRAINEES,
    NoClustersError,
    cluster_trainees,
    one_peak_p,
)
from Testing.error_rates.measured import Measured, share_of, share_text

HEADER = ("one population", "mistaken for several")
POWER_HEADER = ("several populations", "found", "found with stability check (100 studies)")
SIZES = (8, 12, 20, 40)
POPULATIONS = (
    *("normal, correlated", "log-normal, correlated", "log-normal, independent"),
    *("t with 3 degrees of freedom, correlated", "exponential, independent", "uniform"),
)
METRICS = 4


def one_population(sets: int, seed: int = 3) -> list[Measured]:
    """Return how often groups are reported for one population; never below 12 trainees."""
    found = []
    for kind in POPULATIONS:
        for trainees in SIZES:
            random = np.random.default_rng([seed, trainees])
            drawn = _population(kind, random, (sets, trainees, METRICS))
            parted = [_is_parted(values) for values in drawn]
            words = f"{kind}, {trainees} trainees"
            found.append(Measured(words, share_of(parted), sets, at_most=0.06))
    return found


def several_populations(sets: int, seed: int = 4) -> list[Measured]:
    """Return how often groups that are there are found.

    The distance of two groups is measured between their means in standard deviations within a
    group, over all metrics together: 5 are 2.5 in each of four metrics.
    """
    cases = [
        (2, distance, trainees, None)
        for distance, trainees in ((4, 20), (5, 12), (5, 20), (5, 40), (6, 12))
    ]
    cases += [(2, 6, 20, 0.8), (2, 6, 40, 0.8), (2, 8, 12, 0.8), (3, 6, 24, None), (3, 8, 24, 0.8)]
    found = []
    for groups, distance, trainees, at_least in cases:
        random = np.random.default_rng([seed, groups, distance, trainees])
        drawn = random.normal(size=(sets, trainees, METRICS))
        member = np.arange(trainees) * groups // trainees
        drawn += member[:, None] * distance / np.sqrt(METRICS)
        parted = [_is_parted(values) for values in drawn]
        detected = share_of([_is_detected(values) for values in drawn[: max(1, sets // 20)]])
        apart = f"{distance} SD apart" if groups == 2 else f"{distance} SD between neighbors"
        words = f"{groups} groups of {trainees // groups}, {apart}"
        further = (share_text(detected),)
        found.append(Measured(words, share_of(parted), sets, at_least=at_least, further=further))
    return found


def _is_parted(values: np.ndarray) -> bool:
    """Return whether (n, m) values pass the test that stands before all groups."""
    if len(values) < MIN_TRAINEES:
        return False
    return one_peak_p((values - values.mean(axis=0)) / values.std(axis=0, ddof=1)) <= ALPHA


def _is_detected(values: np.ndarray) -> bool:
    names = [f"m{column}" for column in range(values.shape[1])]
    trainees = {f"T{row:03d}": dict(zip(names, own, strict=True)) for row, own in enumerate(values)}
    with contextlib.suppress(NoClustersError):
        cluster_trainees(trainees, names)
        return True
    return False


def _population(kind: str, random: np.random.Generator, shape: tuple[int, int, int]) -> np.ndarray:
    common = random.normal(size=(*shape[:2], 1))
    correlated = np.sqrt(0.5) * (common + random.normal(size=shape))
    if kind.startswith("normal"):
        return correlated
    if kind == "log-normal, correlated":
        return np.exp(0.8 * correlated)
    if kind == "log-normal, independent":
        return np.exp(random.normal(size=shape))
    if kind.startswith("t"):
        return correlated / np.sqrt(random.chisquare(3, (*shape[:2], 1)) / 3)
    if kind.startswith("exponential"):
        return random.exponential(size=shape)
    # One skill that is uniform, seen by all metrics: the hardest population with one peak.
    return random.random((*shape[:2], 1)) + 0.05 * random.normal(size=shape)
