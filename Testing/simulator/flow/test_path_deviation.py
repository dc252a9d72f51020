"""The path between two points, and the words for a direction."""

from __future__ import annotations

import math

import pytest

from rastrainer_simulator.flow.arm_screen import direction_words, off_path
from rastrainer_simulator.teleoperation.steering import ROBOT_AXES

PATH = {"center": (0.5, 0.0, 0.2), "start": (0.6, 0.0, 0.2), "end": (0.5, 0.1, 0.2)}


def around(angle_deg, height=0.0, lift=1.0):
    """Return a place over the equator of a head of 0.1 m, at an angle from the start."""
    angle = math.radians(angle_deg)
    return (0.5 + 0.1 * lift * math.cos(angle), 0.1 * lift * math.sin(angle), 0.2 + height)


@pytest.mark.parametrize("angle_deg", [0, 20, 45, 90])
@pytest.mark.parametrize("lift", [1.0, 1.5])
def test_on_the_arc_the_tip_is_on_the_path_at_any_height(angle_deg, lift):
    assert off_path(around(angle_deg, lift=lift), **PATH) == pytest.approx(0.0, abs=1e-6)


def test_beside_the_arc_the_deviation_is_the_distance_along_the_head():
    # On a sphere of 0.1 m, 0.3 rad from the arc's plane: 0.03 m.
    tip = (0.5 + 0.1 * math.cos(0.3) * math.cos(0.7), 0.1 * math.cos(0.3) * math.sin(0.7))
    assert off_path((*tip, 0.2 + 0.1 * math.sin(0.3)), **PATH) == pytest.approx(0.03)


def test_before_the_start_and_past_the_end_the_nearer_end_counts():
    assert off_path(around(-30), **PATH) == pytest.approx(0.1 * math.radians(30))
    assert off_path(around(120), **PATH) == pytest.approx(0.1 * math.radians(30))
    assert off_path(around(-180), **PATH) == pytest.approx(0.1 * math.radians(90))


def test_a_path_of_zero_length_is_a_point():
    path = {**PATH, "end": PATH["start"]}
    assert off_path(around(40), **path) == pytest.approx(0.1 * math.radians(40))


@pytest.mark.parametrize(
    ("target", "words"),
    [
        ((0.1, 0.0, 0.0), ("forward",)),
        ((-0.1, 0.0, 0.05), ("back", "up")),
        ((0.0, 0.1, -0.2), ("down", "left")),
        ((0.01, -0.1, 0.0), ("right",)),
    ],
)
def test_directions_are_listed_longest_first_and_short_ones_are_omitted(target, words):
    # The robot's own axes: x is forward, y left, z up.
    assert direction_words((0.0, 0.0, 0.0), target, ROBOT_AXES) == words
