"""Clusters of trainees by performance: the paper's future work, with the proof or a refusal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.clusters.k_means import k_means, silhouettes, stability
from rastrainer.errors import RASTrainerError

FEWEST_TRAINEES = 12
TRAINEES_A_CLUSTER = 5
MOST_CLUSTERS = 5
STABLE = 0.75
"""Hennig 2007: below it, a cluster should not be trusted."""
REFERENCE_ROUNDS = 100
STABILITY_ROUNDS = 100


class NoClustersError(RASTrainerError):
    """No groups can be told; the message says why."""


@dataclass(frozen=True)
class TraineeClusters:
    """Groups of trainees.

    Attributes:
        metrics: Names of what they were grouped by.
        members: Pseudonyms of each cluster, the largest cluster first.
        centers: Mean of each cluster in the metrics' own units.
        silhouette: Mean silhouette, -1 to 1.
        chance_silhouette: What 95 of 100 samples without any groups stay below.
        stability: Mean Jaccard similarity of each cluster under resampling, 0 to 1.
    """

    metrics: tuple[str, ...]
    members: tuple[tuple[str, ...], ...]
    centers: tuple[tuple[float, ...], ...]
    silhouette: float
    chance_silhouette: float
    stability: tuple[float, ...]


def cluster_trainees(
    trainees: Mapping[str, Mapping[str, float]], metrics: Sequence[str], seed: int = 0
) -> TraineeClusters:
    """Group trainees by z-scored metrics with k-means.

    The number of clusters is the one with the best mean silhouette. Groups are told only if that
    is better than in samples of one normal distribution with the same correlations, and if every
    cluster comes back when trainees are resampled.

    Args:
        trainees: Pseudonym → metric → mean of the trainee.
        metrics: Which to use; each trainee needs all of them.
        seed: Of the starts and the resampling.

    Raises:
        NoClustersError: too few trainees, metrics that do not vary, or groups that chance makes.
    """
    names = sorted(name for name, values in trainees.items() if set(metrics) <= set(values))
    if len(names) < FEWEST_TRAINEES:
        raise NoClustersError(
            f"Groups of trainees are not told for fewer than {FEWEST_TRAINEES} trainees with all "
            f"metrics; there are {len(names)}."
        )
    values = np.array([[trainees[name][metric] for metric in metrics] for name in names])
    spread = values.std(axis=0, ddof=1)
    if not np.all(spread > 0):
        raise NoClustersError("Groups of trainees need metrics that vary between trainees.")
    points = (values - values.mean(axis=0)) / spread
    random = np.random.default_rng(seed)
    labels, silhouette = _best(points, random)
    chance = _by_chance(points, random)
    if silhouette <= chance:
        raise NoClustersError(
            f"The trainees form no groups: the best grouping (silhouette {silhouette:.2f}) is no "
            f"better than what chance makes of one group ({chance:.2f})."
        )
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
        chance_silhouette=chance,
        stability=tuple(stable[order].tolist()),
    )


def _best(points: np.ndarray, random: np.random.Generator) -> tuple[np.ndarray, float]:
    """Return the labels, from 0 without gaps, and the mean silhouette of the best number."""
    most = min(MOST_CLUSTERS, len(points) // TRAINEES_A_CLUSTER)
    found = []
    for count in range(2, max(2, most) + 1):
        labels = np.unique(k_means(points, count, random), return_inverse=True)[1]
        found.append((labels, float(silhouettes(points, labels).mean())))
    return max(found, key=lambda one: one[1])


def _by_chance(points: np.ndarray, random: np.random.Generator) -> float:
    covariance = np.atleast_2d(np.cov(points.T))
    samples = [
        random.multivariate_normal(np.zeros(points.shape[1]), covariance, len(points))
        for _ in range(REFERENCE_ROUNDS)
    ]
    return float(np.quantile([_best(sample, random)[1] for sample in samples], 0.95))
