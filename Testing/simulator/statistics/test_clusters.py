"""Groups of trainees are found only if they exist."""

import contextlib

import numpy as np
import pytest

from rastrainer_simulator.statistics.trainee_clusters import (
    NoClustersError,
    cluster_trainees,
    dip,
    silhouettes,
)

METRICS = ("time_s", "error_mm", "sparc")


def cohort(centers, each, spread, seed=0):
    rng = np.random.default_rng(seed)
    rows = np.concatenate([rng.normal(center, spread, (each, 3)) for center in centers])
    return {f"T{i:03d}": dict(zip(METRICS, row, strict=True)) for i, row in enumerate(rows)}


def test_three_groups_are_found_with_their_members_and_means():
    centers = [(90, 1.0, -2.0), (150, 1.1, -3.0), (110, 2.5, -4.0)]
    found = cluster_trainees(cohort(centers, 10, (6, 0.1, 0.15)), METRICS)
    assert sorted(map(len, found.members)) == [10, 10, 10]
    groups = {frozenset(int(name[1:]) // 10 for name in members) for members in found.members}
    assert groups == {frozenset({0}), frozenset({1}), frozenset({2})}
    for members, center in zip(found.members, found.centers, strict=True):
        assert center[0] == pytest.approx(centers[int(members[0][1:]) // 10][0], abs=5)
    assert found.dip_p < 0.05
    assert min(found.stability) > 0.9


def test_one_group_is_not_split():
    refused = 0
    for seed in range(5):
        with contextlib.suppress(NoClustersError):
            cluster_trainees(cohort([(120, 1.5, -3.0)], 30, (20, 0.3, 0.4), seed), METRICS)
            continue
        refused += 1
    assert refused >= 4


def test_few_trainees_and_constant_metrics_are_refused_with_a_message():
    few = cohort([(90, 1, -2), (200, 3, -4)], 2, (1, 0.01, 0.01))
    with pytest.raises(NoClustersError, match=r"fewer than 12 trainees .* there are 4"):
        cluster_trainees(few, METRICS)
    same = {name: {**values, "sparc": -2.0} for name, values in cohort([(9, 1, 0)], 20, 1).items()}
    with pytest.raises(NoClustersError, match="metrics that vary"):
        cluster_trainees(same, METRICS)


def test_the_dip_is_hartigans():
    """The package diptest 0.12, which is Hartigans' own program, gives the first value."""
    peaks = [1, 2, 2.5, 3, 10, 11, 11.2, 12.5, 13]
    assert dip(np.array(peaks)) == pytest.approx(0.1728395061728395, abs=1e-12)
    assert dip(np.arange(10.0)) == pytest.approx(1 / 20)
    assert dip(np.repeat([0.0, 1.0], 5)) == pytest.approx(0.25)
    # Many equal values may be the peak.
    assert dip(np.array([-1.5, -0.5, 0.1, 0.1, 0.1, 0.3])) == pytest.approx(1 / 12)


def test_silhouettes_are_rousseeuws():
    points = np.array([[0.0], [1.0], [5.0], [6.0], [20.0]])
    labels = np.array([0, 0, 1, 1, 2])
    # Computed by hand: (b − a)/max(a, b), and 0 for a cluster of one.
    expected = [(5.5 - 1) / 5.5, (4.5 - 1) / 4.5, (4.5 - 1) / 4.5, (5.5 - 1) / 5.5, 0.0]
    np.testing.assert_allclose(silhouettes(points, labels), expected)
