"""How far the tool is pressed in, from the motion commanded and the motion carried out."""

from __future__ import annotations

import pytest

from rastrainer_simulator.collision.clearance import FAR, Clearance, Nearest
from rastrainer_simulator.collision.proximity import DEEPEST, Pressing
from rastrainer_simulator.collision.sliding import REST
from rastrainer_simulator.vectors import ZERO

UP = (0.0, 0.0, 1.0)


def skin(tip_m=REST, shaft=None):
    """Return clearances above level skin, unless the shaft is given as (m, normal)."""
    behind = None if shaft is None else Nearest(shaft[0], ZERO, shaft[1], 0)
    return Clearance(Nearest(tip_m, ZERO, UP, 0), behind, FAR, "", FAR, (), FAR, "")


@pytest.fixture
def pressing():
    return Pressing()


def test_what_is_commanded_into_the_skin_and_not_carried_out_adds_up(pressing):
    for _ in range(4):
        pressing.move((0.0, 0.0, -0.0005), ZERO, skin())
    assert pressing.depth == pytest.approx(0.002)
    pressing.move((0.0, 0.0, -0.0005), (0.0, 0.0, -0.0002), skin())
    assert pressing.depth == pytest.approx(0.0023)


def test_motion_along_the_skin_is_no_pressing(pressing):
    pressing.move((0.003, 0.001, 0.0), (0.003, 0.001, 0.0), skin())
    pressing.move((0.003, 0.001, 0.0), ZERO, skin())
    assert pressing.depth == 0.0


def test_an_oblique_push_counts_by_its_part_into_the_skin(pressing):
    pressing.move((0.003, 0.0, -0.0004), (0.003, 0.0, 0.0), skin())
    assert pressing.depth == pytest.approx(0.0004)


def test_what_is_commanded_outward_takes_it_back_but_not_below_nothing(pressing):
    pressing.move((0.0, 0.0, -0.002), ZERO, skin())
    pressing.move((0.0, 0.0, 0.0005), (0.0, 0.0, 0.0), skin())
    assert pressing.depth == pytest.approx(0.0015)
    pressing.move((0.0, 0.0, 0.005), (0.0, 0.0, 0.0001), skin())
    assert pressing.depth == 0.0
    assert pressing.deepest == pytest.approx(0.002)


def test_the_way_that_was_free_is_no_pressing_even_where_the_arm_was_too_slow(pressing):
    pressing.move((0.0, 0.0, -0.0005), (0.0, 0.0, -0.0003), skin(REST + 0.0002))
    assert pressing.depth == pytest.approx(0.0, abs=1e-12)
    pressing.move((0.0, 0.0, -0.0005), (0.0, 0.0, -0.0002), skin(REST))
    assert pressing.depth == pytest.approx(0.0003)


def test_the_end_of_contact_ends_it_and_the_deepest_is_kept_until_the_next(pressing):
    pressing.move((0.0, 0.0, -0.002), ZERO, skin())
    pressing.end()
    assert (pressing.depth, pressing.deepest) == (0.0, pytest.approx(0.002))
    pressing.move((0.0, 0.0, -0.001), ZERO, skin())
    assert (pressing.depth, pressing.deepest) == (pytest.approx(0.001), pytest.approx(0.001))


def test_ten_millimeters_are_the_most(pressing):
    for _ in range(30):
        pressing.move((0.0, 0.0, -0.0005), ZERO, skin())
    assert pressing.depth == pressing.deepest == DEEPEST == 0.01


def test_a_move_presses_no_farther_than_where_it_shall_end(pressing):
    for _ in range(100):
        pressing.move((0.0, 0.0, -0.0005), ZERO, skin(), to_goal=(0.01, 0.0, -0.002))
    assert pressing.depth == pytest.approx(0.002)
    pressing.move((0.0, 0.0, -0.0005), ZERO, skin(), to_goal=(0.01, 0.0, -0.001))
    assert pressing.depth == pytest.approx(0.002)


def test_of_tip_and_shaft_the_nearer_part_counts(pressing):
    sideways = (1.0, 0.0, 0.0)
    pressing.move((-0.001, 0.0, 0.0), ZERO, skin(0.004, (REST, sideways)))
    assert pressing.depth == pytest.approx(0.001)
    pressing.move((-0.001, 0.0, 0.0), ZERO, skin(REST, (0.001, sideways)))
    assert pressing.depth == pytest.approx(0.001)
