"""Clusters of trainees by performance: the paper's future work, with the proof or a refusal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.clusters.dip import dip_p
from rastrainer.clusters.k_means import k_means, silhouettes, stability
from rastrainer.errors import RASTrainerError
from rastrainer.number_text import p_phrase

FEWEST_TRAINEES = 12
TRAINEES_A_CLUSTER = 5
MOST_CLUSTERS = 5
STABLE = 0.75
"""Hennig 2007: below it, a cluster should not be trusted."""
ALPHA = 0.05
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
        dip_p: How often a population with a single peak looks at least as parted as this.
        stability: Mean Jaccard similarity of each cluster under resampling, 0 to 1.
    """

    metrics: tuple[str, ...]
    members: tuple[tuple[str, ...], ...]
    centers: tuple[tuple[float, ...], ...]
    silhouette: float
    dip_p: float
    stability: tuple[float, ...]


def cluster_trainees(
    trainees: Mapping[str, Mapping[str, float]], metrics: Sequence[str], seed: int = 0
) -> TraineeClusters:
    """Group trainees by z-scored metrics with k-means.

    Any population can be cut, and a skewed one is cut better than a normal one. So groups are told
    only if there is more than one peak: Hartigans' dip test on the first principal component, which
    is chosen without looking for groups, at 5 % for every population with a single peak. The number
    of clusters is the one with the best mean silhouette, and every cluster must come back when
    trainees are resampled.

    Args:
        trainees: Pseudonym → metric → mean of the trainee.
        metrics: Which to use; each trainee needs all of them.
        seed: Of the starts and the resampling.

    Raises:
        NoClustersError: too few trainees, metrics that do not vary, or no groups are shown.
    """
    names = sorted(name for name, values in trainees.items() if set(metrics) <= set(values))
    if len(names) < FEWEST_TRAINEES:
        raise NoClustersError(
            f"Groups of trainees are not reported for fewer than {FEWEST_TRAINEES} trainees "
            f"with all metrics; there are {len(names)}."
        )
    values = np.array([[trainees[name][metric] for metric in metrics] for name in names])
    spread = values.std(axis=0, ddof=1)
    if not metrics or not np.all(spread > 0):
        raise NoClustersError("Groups of trainees need metrics that vary between trainees.")
    points = (values - values.mean(axis=0)) / spread
    random = np.random.default_rng(seed)
    p = one_peak_p(points)
    if p > ALPHA:
        raise NoClustersError(
            f"No groups are shown: {len(names)} trainees of one group would often look as clearly "
            f"divided as these (dip test, {p_phrase(p)}). That is not evidence that there are none."
        )
    labels, silhouette = _best(points, random)
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


def _best(points: np.ndarray, random: np.random.Generator) -> tuple[np.ndarray, float]:
    """Return the labels, from 0 without gaps, and the mean silhouette of the best number."""
    most = min(MOST_CLUSTERS, len(points) // TRAINEES_A_CLUSTER)
    found = []
    for count in range(2, max(2, most) + 1):
        labels = np.unique(k_means(points, count, random), return_inverse=True)[1]
        found.append((labels, float(silhouettes(points, labels).mean())))
    return max(found, key=lambda one: one[1])
