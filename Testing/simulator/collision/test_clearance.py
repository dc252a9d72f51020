"""Nothing comes near unnoticed."""

import numpy as np
import pytest

from rastrainer_simulator.collision.clearance import FAR, DistanceBounds

COUNT, TICKS = 40, 1000


def walk(rough):
    """A point among others: in each tick its distances, and which of them were checked."""
    random = np.random.default_rng(26)
    others, point, traveled = random.uniform(-0.3, 0.3, (COUNT, 3)), np.zeros(3), 0.0
    bounds = DistanceBounds(COUNT)
    for _ in range(TICKS):
        step = random.normal(size=3) * 0.002 - 0.0002 * point
        point, traveled = point + step, traveled + np.linalg.norm(step)
        distances = np.linalg.norm(others - point, axis=1)
        rows = bounds.due(traveled, (lambda found=distances: found - 0.01) if rough else None)
        for row in rows:
            bounds.put_off(row, distances[row], traveled)
        yield distances, rows


@pytest.mark.parametrize("rough", [False, True])
def test_anything_near_is_checked_in_every_tick(rough):
    near = 0
    for distances, rows in walk(rough):
        assert set(np.flatnonzero(distances < FAR)) <= set(rows)
        near += (distances < FAR).sum()
    assert near > TICKS / 10
