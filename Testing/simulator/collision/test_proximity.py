from itertools import pairwise

import numpy as np
import pytest

from rastrainer.protocol import Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.clearance import FAR, SHAFT_NEAR, Clearance
from rastrainer_simulator.collision.contact import REST
from rastrainer_simulator.collision.head_surface import Nearest
from rastrainer_simulator.collision.proximity import Pressing, ProximitySettings, next_proximity
from rastrainer_simulator.vectors import ZERO

FREE, PROXIMITY, CONTACT = Proximity.FREE, Proximity.PROXIMITY, Proximity.CONTACT


def clearance(tip_mm, shaft_mm=1000.0):
    def nearest(distance_mm):
        return Nearest(distance_mm / MM_PER_M, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0)

    tip, shaft = nearest(tip_mm), nearest(shaft_mm)
    tool_m = min(tip.distance_m, shaft.distance_m)
    return Clearance(tip, shaft, shaft.distance_m, tool_m, FAR, FAR, FAR)


def states(tips_mm):
    found, state = [], FREE
    for tip_mm in tips_mm:
        state = next_proximity(state, clearance(tip_mm), ProximitySettings())
        found.append(state)
    return found


def test_the_tool_approaches_touches_and_leaves():
    clearances = [50.0, 20.5, 20.0, 10.0, 0.06, 0.05, 0.01, 0.2, 0.31, 20.9, 21.1, 50.0]
    assert (
        states(clearances)
        == [FREE] * 2 + [PROXIMITY] * 3 + [CONTACT] * 3 + [PROXIMITY] * 2 + [FREE] * 2
    )


def test_no_state_flickers_while_the_hand_trembles_at_its_threshold():
    random = np.random.default_rng(31)
    for edge_mm, shiver_mm in ((20.0, 0.4), (20.5, 0.4), (0.05, 0.04), (0.15, 0.1)):
        found = states(edge_mm + random.uniform(-shiver_mm, shiver_mm, 200))
        assert sum(a is not b for a, b in pairwise(found)) <= 1


UP = (0.0, 0.0, 1.0)


def skin(tip_m=REST, shaft=None):
    """Return clearances above level skin, unless the shaft is given as (m, normal)."""
    behind = None if shaft is None else Nearest(shaft[0], ZERO, shaft[1], 0)
    shaft_m = max(tip_m, SHAFT_NEAR) if shaft is None else shaft[0]
    tip = Nearest(tip_m, ZERO, UP, 0)
    return Clearance(tip, behind, shaft_m, min(tip_m, shaft_m), FAR, FAR, FAR)


@pytest.fixture
def pressing():
    return Pressing()


def test_commanded_motion_into_the_skin_that_is_not_carried_out_adds_up(pressing):
    for _ in range(4):
        pressing.move((0.0, 0.0, -0.0005), ZERO, skin())
    assert pressing.depth == pytest.approx(0.002)
    pressing.move((0.0, 0.0, -0.0005), (0.0, 0.0, -0.0002), skin())
    assert pressing.depth == pytest.approx(0.0023)
    # Only the part into the skin.
    pressing.move((0.003, 0.0, -0.0004), (0.003, 0.0, 0.0), skin())
    assert pressing.depth == pytest.approx(0.0027)


def test_free_motion_is_not_pressing_even_if_the_arm_was_too_slow(pressing):
    pressing.move((0.0, 0.0, -0.0005), (0.0, 0.0, -0.0003), skin(REST + 0.0002))
    assert pressing.depth == pytest.approx(0.0, abs=1e-12)
    pressing.move((0.0, 0.0, -0.0005), (0.0, 0.0, -0.0002), skin(REST))
    assert pressing.depth == pytest.approx(0.0003)


def test_the_nearer_of_tip_and_shaft_counts(pressing):
    sideways = (1.0, 0.0, 0.0)
    pressing.move((-0.001, 0.0, 0.0), ZERO, skin(0.004, (REST, sideways)))
    assert pressing.depth == pytest.approx(0.001)
    pressing.move((-0.001, 0.0, 0.0), ZERO, skin(REST, (0.001, sideways)))
    assert pressing.depth == pytest.approx(0.001)
