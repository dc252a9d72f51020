"""How far the tip may go along a surface."""

import pytest

from rastrainer_simulator.collision.clearance import Nearest
from rastrainer_simulator.collision.sliding import LONGEST_STEP, REST, slide
from rastrainer_simulator.vectors import add

UP = (0.0, 0.0, 1.0)


def nearest_on_floor(point):
    x, y, z = point
    return Nearest(z, (x, y, 0.0), UP, 0)


@pytest.mark.parametrize("height", [REST, 0.5 * REST, 0.0, -REST])
@pytest.mark.parametrize("steps", [0.5, 2.0, 7.0])
def test_a_tip_that_is_pressed_on_slides_all_the_way_however_near_it_was(height, steps):
    tip, push = (0.3, 0.1, height), (steps * LONGEST_STEP, 0.0, -steps * LONGEST_STEP)
    way = slide(nearest_on_floor, tip, nearest_on_floor(tip), push, ())
    x, y, _ = add(tip, push)
    assert way.position == pytest.approx((x, y, REST), abs=1e-8)
