"""k-means, silhouettes and how stable clusters are, on numpy alone."""

from __future__ import annotations

import numpy as np

STARTS = 10
MOST_ROUNDS = 100


def k_means(points: np.ndarray, count: int, random: np.random.Generator) -> np.ndarray:
    """Return the cluster of each of (n, m) points, (n,) int (Lloyd 1982).

    The best of several starts, which run side by side; a cluster that loses its last point keeps
    its center.
    """
    centers = _spread_out(points, count, random)
    labels = np.full((STARTS, len(points)), -1)
    for _ in range(MOST_ROUNDS):
        squared = ((points[None, :, None] - centers[:, None]) ** 2).sum(axis=3)
        new = squared.argmin(axis=2)
        if np.array_equal(new, labels):
            break
        labels = new
        belongs = (labels[:, :, None] == np.arange(count)).astype(float)
        sizes = belongs.sum(axis=1)[:, :, None]
        sums = np.einsum("snk,nm->skm", belongs, points)
        centers = np.where(sizes > 0, sums / np.maximum(sizes, 1), centers)
    return labels[squared.min(axis=2).sum(axis=1).argmin()]


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


def _spread_out(points: np.ndarray, count: int, random: np.random.Generator) -> np.ndarray:
    """Return starting centers far from each other (k-means++, Arthur and Vassilvitskii 2007).

    Shape (starts, count, m).
    """
    centers = points[random.integers(0, len(points), (STARTS, 1))]
    while centers.shape[1] < count:
        squared = ((points[None, :, None] - centers[:, None]) ** 2).sum(axis=3).min(axis=2)
        # Points that lie on a center already have no chance, unless all do.
        chances = np.cumsum(squared + 1e-300, axis=1)
        drawn = random.random(STARTS)[:, None] * chances[:, -1:]
        chosen = (chances < drawn).sum(axis=1)
        centers = np.concatenate([centers, points[chosen][:, None]], axis=1)
    return centers
