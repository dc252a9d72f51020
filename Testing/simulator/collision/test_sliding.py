"""Half-spaces that limit a motion, and how far the tip slides along a surface."""

import numpy as np
import pytest
from scipy.optimize import minimize

from rastrainer_simulator.collision.contact import (
    LONGEST_STEP,
    REST,
    HalfSpace,
    nearest_inside,
    slide,
)
from rastrainer_simulator.collision.head_surface import Nearest
from rastrainer_simulator.vectors import add


def half_space(normal, bound):
    return HalfSpace(tuple(np.asarray(normal, dtype=float) / np.linalg.norm(normal)), bound)


def random_half_spaces(random, count):
    """Half-spaces with a point that is inside all of them."""
    inside, normals = random.normal(size=3), random.normal(size=(count, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    return [half_space(n, n @ inside - random.uniform(0.0, 0.5)) for n in normals]


@pytest.mark.parametrize("count", [2, 6])
def test_the_point_matches_the_one_that_scipy_finds(count):
    random = np.random.default_rng(count)
    for _ in range(20):
        goal, planes = random.normal(size=3), random_half_spaces(random, count)
        found = nearest_inside(tuple(goal), planes)
        assert found is not None
        limits = [
            {"type": "ineq", "fun": lambda x, plane=plane: plane.normal @ x - plane.bound}
            for plane in planes
        ]
        expected = minimize(
            lambda x, goal=goal: ((x - goal) ** 2).sum(), found, constraints=limits, tol=1e-12
        )
        np.testing.assert_allclose(found, expected.x, atol=1e-5)
        assert all(np.dot(plane.normal, found) >= plane.bound - 1e-9 for plane in planes)


UP = (0.0, 0.0, 1.0)


def nearest_on_floor(point):
    x, y, z = point
    return Nearest(z, (x, y, 0.0), UP, 0)


def test_a_pressed_tip_slides_the_whole_way_however_near_it_was():
    for height, steps in ((REST, 0.5), (0.5 * REST, 7.0), (-REST, 2.0)):
        tip, push = (0.3, 0.1, height), (steps * LONGEST_STEP, 0.0, -steps * LONGEST_STEP)
        path = slide(nearest_on_floor, tip, nearest_on_floor(tip), push, ())
        x, y, _ = add(tip, push)
        assert path.position == pytest.approx((x, y, REST), abs=1e-8)
