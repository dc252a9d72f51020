"""The path between two points of the head."""

from __future__ import annotations

import math

import pytest

from rastrainer_simulator.flow.arm_screen import off_path

PATH = {"center": (0.5, 0.0, 0.2), "start": (0.6, 0.0, 0.2), "end": (0.5, 0.1, 0.2)}


def around(angle_deg, height=0.0, lift=1.0):
    """Return a place over the equator of a head of 0.1 m, at an angle from the start."""
    angle = math.radians(angle_deg)
    return (0.5 + 0.1 * lift * math.cos(angle), 0.1 * lift * math.sin(angle), 0.2 + height)


def test_the_deviation_is_the_distance_along_the_head_at_any_height():
    for angle_deg, lift in ((0, 1.0), (45, 1.5), (90, 1.0)):
        assert off_path(around(angle_deg, lift=lift), **PATH) == pytest.approx(0.0, abs=1e-6)
    # On a sphere of 0.1 m, 0.3 rad from the arc's plane: 0.03 m.
    tip = (0.5 + 0.1 * math.cos(0.3) * math.cos(0.7), 0.1 * math.cos(0.3) * math.sin(0.7))
    assert off_path((*tip, 0.2 + 0.1 * math.sin(0.3)), **PATH) == pytest.approx(0.03)
    # Before the start and past the end, the nearer end counts.
    for angle_deg, beyond_deg in ((-30, 30), (120, 30), (-180, 90)):
        expected = 0.1 * math.radians(beyond_deg)
        assert off_path(around(angle_deg), **PATH) == pytest.approx(expected)
    point = {**PATH, "end": PATH["start"]}
    assert off_path(around(40), **point) == pytest.approx(0.1 * math.radians(40))
