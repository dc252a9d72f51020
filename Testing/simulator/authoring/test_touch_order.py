from itertools import permutations

import numpy as np
import pytest

from rastrainer_simulator.authoring.touch_order import crossing_order, easiest_order, ways_between


def ways_of(points):
    points = np.asarray(points, dtype=float)
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    lengths = np.linalg.norm(points[:, None] - points[None], axis=2)
    return ways_between(points, normals, lengths)


def test_points_in_a_row_are_touched_in_a_row():
    places = np.array([3, 0, 5, 1, 4, 2])
    points = np.stack([40.0 * places, np.zeros(6), np.zeros(6)], axis=1)
    order = places[easiest_order(ways_of(points), list(range(6)))].tolist()
    assert order in ([0, 1, 2, 3, 4, 5], [5, 4, 3, 2, 1, 0])


@pytest.mark.parametrize("seed", range(4))
def test_no_order_of_a_few_points_is_easier(seed):
    ways = ways_of(np.random.default_rng(seed).uniform(-80, 80, (7, 3)) * [1, 1, 0])
    best, _ = ways.easiest([list(order) for order in permutations(range(7))])
    assert ways.costs([easiest_order(ways, list(range(7)))])[0] <= 1.05 * best


@pytest.mark.parametrize("crossings", [1, 4, 9, 14])
def test_the_way_changes_sides_as_often_as_asked(crossings):
    points = np.random.default_rng(1).uniform(-80, 80, (15, 3)) * [1, 1, 0]
    by_side = np.argsort(points[:, 0]).tolist()
    sides = [by_side[:8], by_side[8:]]
    order = crossing_order(ways_of(points), sides, crossings)
    assert sorted(order) == list(range(15))
    on_first = [place in sides[0] for place in order]
    assert np.count_nonzero(np.diff(on_first)) == crossings
