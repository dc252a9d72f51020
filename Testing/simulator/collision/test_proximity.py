from itertools import pairwise

import numpy as np
import pytest

from rastrainer.protocol import Proximity
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.collision.clearance import FAR, Clearance, Nearest
from rastrainer_simulator.collision.proximity import ProximitySettings, next_proximity

FREE, PROXIMITY, CONTACT = Proximity.FREE, Proximity.PROXIMITY, Proximity.CONTACT


def clearance(tip_mm, shaft_mm=1000.0):
    def nearest(distance_mm):
        return Nearest(distance_mm / MM_PER_M, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0)

    return Clearance(nearest(tip_mm), nearest(shaft_mm), FAR, "", FAR, (), FAR, "")


def states(tips_mm, settings=ProximitySettings(), start=FREE):  # noqa: B008
    found, state = [], start
    for tip_mm in tips_mm:
        state = next_proximity(state, clearance(tip_mm), settings)
        found.append(state)
    return found


def test_the_tool_comes_near_touches_and_leaves():
    way = [50.0, 20.5, 20.0, 10.0, 0.06, 0.05, 0.01, 0.2, 0.31, 20.9, 21.1, 50.0]
    assert (
        states(way) == [FREE] * 2 + [PROXIMITY] * 3 + [CONTACT] * 3 + [PROXIMITY] * 2 + [FREE] * 2
    )


@pytest.mark.parametrize(
    ("edge_mm", "shiver_mm"), [(20.0, 0.4), (20.5, 0.4), (0.05, 0.04), (0.15, 0.1)]
)
def test_no_state_flickers_while_the_hand_shivers_at_its_edge(edge_mm, shiver_mm):
    random = np.random.default_rng(31)
    found = states(edge_mm + random.uniform(-shiver_mm, shiver_mm, 1000))
    changes = sum(a is not b for a, b in pairwise(found))
    assert changes <= 1


def test_a_fast_tool_goes_from_free_to_contact_and_back_in_one_tick():
    assert states([100.0, 0.0, 100.0]) == [FREE, CONTACT, FREE]


def test_the_shaft_makes_contact_too():
    assert next_proximity(FREE, clearance(40.0, 0.01), ProximitySettings()) is CONTACT
    assert next_proximity(CONTACT, clearance(40.0, 0.2), ProximitySettings()) is CONTACT
    assert next_proximity(CONTACT, clearance(40.0, 0.4), ProximitySettings()) is FREE


def test_inside_the_head_is_contact():
    assert states([-30.0]) == [CONTACT]


def test_the_edges_are_settings():
    settings = ProximitySettings(near=0.01, far=0.012, touching=0.0002, released=0.001)
    assert states([15.0, 9.0, 0.5, 0.1, 0.9, 11.0, 13.0], settings) == [
        FREE,
        PROXIMITY,
        PROXIMITY,
        CONTACT,
        CONTACT,
        PROXIMITY,
        FREE,
    ]
