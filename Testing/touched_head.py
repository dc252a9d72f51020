"""Fiducials of a head and their touches, drawn at random."""

import numpy as np
import pytest


def random_rotation(rng):
    q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return q * np.sign(np.linalg.det(q))


def head_points(rng, count=15):
    """Points on the upper half of a head-sized ellipsoid, (n, 3), mm."""
    directions = rng.normal(size=(count, 3))
    directions[:, 2] = np.abs(directions[:, 2])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return directions * [75.0, 95.0, 85.0]


@pytest.fixture
def touched_head():
    """Make (moving, fixed, rng): fiducials and their touches in a posed head, noise 1-1.5 mm."""

    def make(seed, count=15):
        rng = np.random.default_rng(seed)
        fixed = head_points(rng, count)
        noise_mm = rng.uniform(1.0, 1.5)
        touched = fixed + rng.normal(size=fixed.shape) * noise_mm / np.sqrt(3)
        moving = touched @ random_rotation(rng).T + rng.uniform(-500, 500, 3)
        return moving, fixed, rng

    return make
