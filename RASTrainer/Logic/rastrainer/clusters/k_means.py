"""k-means, silhouettes and how stable clusters are, on numpy alone."""

from __future__ import annotations

import numpy as np

STARTS = 20
MOST_ROUNDS = 100


def k_means(points: np.ndarray, count: int, random: np.random.Generator) -> np.ndarray:
    """Return the cluster of each of (n, m) points, (n,) int; the best of several starts (Lloyd)."""
    results = [_one_run(points, count, random) for _ in range(STARTS)]
    return min(results, key=lambda result: result[1])[0]


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
        again = k_means(points[chosen], len(clusters), random)
        for column, cluster in enumerate(clusters):
            is_old = labels[chosen] == cluster
            found[row, column] = max(
                (is_old & (again == new)).sum() / max(1, (is_old | (again == new)).sum())
                for new in np.unique(again)
            )
    return found.mean(axis=0)


def _one_run(
    points: np.ndarray, count: int, random: np.random.Generator
) -> tuple[np.ndarray, float]:
    centers = _spread_out(points, count, random)
    labels = np.full(len(points), -1)
    for _ in range(MOST_ROUNDS):
        squared = ((points[:, None] - centers[None]) ** 2).sum(axis=2)
        new = squared.argmin(axis=1)
        if np.array_equal(new, labels):
            break
        labels = new
        for cluster in range(count):
            if np.any(labels == cluster):
                centers[cluster] = points[labels == cluster].mean(axis=0)
    return labels, float(squared[np.arange(len(points)), labels].sum())


def _spread_out(points: np.ndarray, count: int, random: np.random.Generator) -> np.ndarray:
    """Return starting centers far from each other (k-means++, Arthur and Vassilvitskii 2007)."""
    centers = [points[random.integers(len(points))]]
    while len(centers) < count:
        squared = ((points[:, None] - np.array(centers)[None]) ** 2).sum(axis=2).min(axis=1)
        total = squared.sum()
        chances = squared / total if total > 0 else None
        centers.append(points[random.choice(len(points), p=chances)])
    return np.array(centers)
