"""Clusters of trainees by performance: the paper's future work, with the proof or a refusal."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from rastrainer.errors import RASTrainerError
from rastrainer.number_text import p_phrase
from rastrainer_simulator.statistics.intervals import ALPHA

MIN_TRAINEES = 12
TRAINEES_A_CLUSTER = 5
MAX_CLUSTERS = 5
STABLE = 0.75
"""Hennig 2007: below it, a cluster should not be trusted."""
STABILITY_ROUNDS = 100


class NoClustersError(RASTrainerError):
    """No groups can be reported; the message says why."""


@dataclass(frozen=True)
class TraineeClusters:
    """Groups of trainees: pseudonyms and means of each cluster, the largest cluster first.

    `dip_p` is how often a population with a single peak looks at least as parted as this, and the
    stability of a cluster its mean Jaccard similarity under resampling, 0 to 1.
    """

    metrics: tuple[str, ...]
    members: tuple[tuple[str, ...], ...]
    centers: tuple[tuple[float, ...], ...]
    silhouette: float
    dip_p: float
    stability: tuple[float, ...]


def cluster_trainees(
    trainees: Mapping[str, Mapping[str, float]], metrics: Sequence[str]
) -> TraineeClusters:
    """Group trainees by z-scored metrics with k-means.

    Any population can be cut, and a skewed one is cut better than a normal one. So groups are
    reported only if there is more than one peak: Hartigans' dip test on the first principal
    component, which is chosen without looking for groups, at 5 % for every population with a single
    peak. The number of clusters with the best mean silhouette is taken, and every cluster must
    come back when trainees are resampled. Otherwise, `NoClustersError` says why there are none.
    """
    names = sorted(name for name, values in trainees.items() if set(metrics) <= set(values))
    if len(names) < MIN_TRAINEES:
        raise NoClustersError(
            f"Groups of trainees are not reported for fewer than {MIN_TRAINEES} trainees "
            f"with all metrics; there are {len(names)}."
        )
    values = np.array([[trainees[name][metric] for metric in metrics] for name in names])
    spread = values.std(axis=0, ddof=1)
    if not metrics or not np.all(spread > 0):
        raise NoClustersError("Groups of trainees need metrics that vary between trainees.")
    points = (values - values.mean(axis=0)) / spread
    random = np.random.default_rng(0)
    p = one_peak_p(points)
    if p > ALPHA:
        raise NoClustersError(
            f"No groups are shown: {len(names)} trainees of one group would often look as clearly "
            f"divided as these (dip test, {p_phrase(p)}). That is not evidence that there are none."
        )
    found = []
    for count in range(2, max(2, min(MAX_CLUSTERS, len(points) // TRAINEES_A_CLUSTER)) + 1):
        labels = np.unique(k_means(points, count, random), return_inverse=True)[1]
        found.append((float(silhouettes(points, labels).mean()), labels))
    silhouette, labels = max(found, key=lambda one: one[0])
    stable = stability(points, labels, random, STABILITY_ROUNDS)
    if stable.min() < STABLE:
        raise NoClustersError(
            f"The groups are not stable: with other trainees, one of them comes back with a "
            f"similarity of {stable.min():.2f} only ({STABLE} is needed)."
        )
    order = np.argsort([-(labels == c).sum() for c in np.unique(labels)], kind="stable")
    return TraineeClusters(
        metrics=tuple(metrics),
        members=tuple(tuple(np.array(names)[labels == c].tolist()) for c in order),
        centers=tuple(tuple(values[labels == c].mean(axis=0).tolist()) for c in order),
        silhouette=silhouette,
        dip_p=p,
        stability=tuple(stable[order].tolist()),
    )


def one_peak_p(points: np.ndarray) -> float:
    """Return how often a population with a single peak looks as parted as (n, m) z-scores.

    The points are looked at along the direction in which they vary most.
    """
    return dip_p(points @ np.linalg.svd(points, full_matrices=False)[2][0])


REFERENCE_SAMPLES = 2000


def dip(values: np.ndarray) -> float:
    """Return the largest distance of the empirical distribution of (n,) values from its nearest
    unimodal one.

    The peak is enclosed from both sides: left of it a unimodal distribution function is convex,
    right of it concave. The next, shorter interval begins and ends where the greatest convex
    minorant and the least concave majorant of the present one are farthest apart.
    """
    x, counts = np.unique(np.asarray(values, dtype=float), return_counts=True)
    n = len(values)
    above = np.cumsum(counts) / n
    below = above - counts / n
    low, high, widest = 0, len(x) - 1, 1 / n
    while True:
        convex = low + _hull(x[low : high + 1], below[low : high + 1], 1)
        concave = low + _hull(x[low : high + 1], above[low : high + 1], -1)
        over_convex = above[concave] - np.interp(x[concave], x[convex], below[convex])
        under_concave = np.interp(x[convex], x[concave], above[concave]) - below[convex]
        if over_convex.max() > under_concave.max():
            apart, right = over_convex.max(), concave[over_convex.argmax()]
            left = convex[convex <= right].max()
        else:
            apart, left = under_concave.max(), convex[under_concave.argmax()]
            right = concave[concave >= left].min()
        if apart <= widest:
            return float(widest / 2)
        # But for its ends: many equal values may well be the peak.
        rising = np.interp(x[low:left], x[convex], below[convex])
        falling = np.interp(x[right + 1 : high + 1], x[concave], above[concave])
        widest = max(
            widest,
            (above[low:left] - rising).max(initial=0.0),
            (falling - below[right + 1 : high + 1]).max(initial=0.0),
        )
        if (left, right) == (low, high):
            return float(widest / 2)
        low, high = left, right


def dip_p(values: np.ndarray) -> float:
    """Return how often (n,) values of a uniform distribution have so large a dip.

    The uniform distribution has the largest dips of all distributions with a single peak, so that
    this p is too large for every other distribution, skewed or heavy-tailed, and never too small.
    """
    reference = _uniform_dips(len(values))
    larger = len(reference) - np.searchsorted(reference, dip(values) - 1e-12)
    return float((larger + 1) / (len(reference) + 1))


@functools.lru_cache(maxsize=64)
def _uniform_dips(n: int) -> np.ndarray:
    random = np.random.default_rng(n)
    return np.sort([dip(row) for row in random.random((REFERENCE_SAMPLES, n))])


def _hull(x: np.ndarray, y: np.ndarray, side: int) -> np.ndarray:
    """Return the rows of the corners of the lower (side 1) or upper (-1) hull of sorted points."""
    if len(x) == 1:
        return np.array([0])
    steps = np.diff(x)
    slopes = scipy.optimize.isotonic_regression(
        np.diff(y) / steps, weights=steps, increasing=side > 0
    )
    return slopes.blocks


STARTS, STARTS_OF_SAMPLE = 10, 3
MAX_ROUNDS = 30


def k_means(
    points: np.ndarray, count: int, random: np.random.Generator, starts: int = STARTS
) -> np.ndarray:
    """Return the cluster of each of (n, m) points, (n,) int: the best of several starts (scipy)."""
    found = []
    with warnings.catch_warnings():
        # A start that loses a cluster is not the best one.
        warnings.simplefilter("ignore", UserWarning)
        for _ in range(starts):
            centers, labels = scipy.cluster.vq.kmeans2(
                points, count, iter=MAX_ROUNDS, minit="++", seed=random
            )
            found.append((float(((points - centers[labels]) ** 2).sum()), labels))
    return min(found, key=lambda one: one[0])[1]


def silhouettes(points: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Return how well each point sits in its cluster, (n,) float, -1 to 1 (Rousseeuw 1987)."""
    members = labels[:, None] == np.unique(labels)
    sizes = members.sum(axis=0)
    sums = scipy.spatial.distance.cdist(points, points) @ members
    own = (members * sizes).sum(axis=1)
    within = (members * sums).sum(axis=1) / np.maximum(own - 1, 1)
    nearest = np.where(members, np.inf, sums / sizes).min(axis=1)
    values = (nearest - within) / np.maximum(within, nearest)
    return np.where(own == 1, 0.0, values)


def stability(
    points: np.ndarray, labels: np.ndarray, random: np.random.Generator, rounds: int
) -> np.ndarray:
    """Return the mean Jaccard similarity of each cluster under resampling (Hennig 2007).

    Each bootstrap sample is clustered; the cluster most like the original one counts.
    """
    clusters = np.unique(labels)
    found = np.zeros((rounds, len(clusters)))
    for row in range(rounds):
        chosen = np.unique(random.integers(0, len(points), len(points)))
        if len(chosen) <= len(clusters):
            continue
        again = k_means(points[chosen], len(clusters), random, STARTS_OF_SAMPLE)
        for column, cluster in enumerate(clusters):
            is_old = labels[chosen] == cluster
            found[row, column] = max(
                (is_old & (again == new)).sum() / max(1, (is_old | (again == new)).sum())
                for new in np.unique(again)
            )
    return found.mean(axis=0)
