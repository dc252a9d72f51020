"""k-means, silhouettes and how stable clusters are."""

from __future__ import annotations

import warnings

import numpy as np

from rastrainer.scipy_modules import scipy_module

STARTS, STARTS_OF_SAMPLE = 10, 3
MOST_ROUNDS = 30


def k_means(
    points: np.ndarray, count: int, random: np.random.Generator, starts: int = STARTS
) -> np.ndarray:
    """Return the cluster of each of (n, m) points, (n,) int: the best of several starts (scipy)."""
    found = [_once(points, count, random) for _ in range(starts)]
    return min(found, key=lambda one: one[0])[1]


def silhouettes(points: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Return how well each point sits in its cluster, (n,) float, -1 to 1 (Rousseeuw 1987)."""
    distances = np.linalg.norm(points[:, None] - points[None], axis=2)
    clusters = np.unique(labels)
    sizes = np.array([(labels == c).sum() for c in clusters])
    sums = np.stack([distances[:, labels == c].sum(axis=1) for c in clusters], axis=1)
    own = np.searchsorted(clusters, labels)
    rows = np.arange(len(points))
    within = sums[rows, own] / np.maximum(sizes[own] - 1, 1)
    means = sums / sizes
    means[rows, own] = np.inf
    nearest = means.min(axis=1)
    values = (nearest - within) / np.maximum(within, nearest)
    return np.where(sizes[own] == 1, 0.0, values)


def stability(
    points: np.ndarray, labels: np.ndarray, random: np.random.Generator, rounds: int
) -> np.ndarray:
    """Return the mean Jaccard similarity of each cluster under resampling (Hennig 2007).

    Of each bootstrap sample clustered anew, the cluster most like the original one counts.
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


def _once(points: np.ndarray, count: int, random: np.random.Generator) -> tuple[float, np.ndarray]:
    """Return the sum of squares and the labels of one start (k-means++)."""
    with warnings.catch_warnings():
        # A start that loses a cluster is not the best one.
        warnings.simplefilter("ignore", UserWarning)
        centers, labels = scipy_module("cluster.vq").kmeans2(
            points, count, iter=MOST_ROUNDS, minit="++", seed=random
        )
    return float(((points - centers[labels]) ** 2).sum()), labels
