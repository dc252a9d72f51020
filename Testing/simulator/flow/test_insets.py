"""The insets: along the skin at the next touch, or across a procedure's planned line."""

import math

import numpy as np
import pytest

from rastrainer_simulator.trial_state import PlannedLine
from rastrainer_simulator.viewpoint.trial_view import AWAY_M, TALLEST_M, across_line, along_skin
from rastrainer_simulator.viewpoint.view_control import UP

EYE = (0.5, -0.6, 0.6)
LINES = {
    "sloping": PlannedLine("", (0.50, 0.05, 0.30), (0.47, 0.09, 0.24)),
    "level": PlannedLine("", (0.58, 0.10, 0.20), (0.50, 0.10, 0.20)),
    "upright": PlannedLine("", (0.50, 0.10, 0.32), (0.50, 0.10, 0.22)),
    "nearly upright": PlannedLine("", (0.501, 0.10, 0.32), (0.50, 0.10, 0.22)),
}


def in_picture(pose, point) -> tuple[float, float]:
    """Return where a point is in the picture: right and up, as shares of half its height."""
    away = np.array(pose.focal_point) - pose.position
    ahead = away / np.linalg.norm(away)
    right = np.cross(ahead, pose.view_up)
    right /= np.linalg.norm(right)
    off = np.array(point) - pose.position
    depth = math.tan(math.radians(pose.view_angle_deg) / 2.0) * (off @ ahead)
    return float(off @ right / depth), float(off @ np.cross(right, ahead) / depth)


@pytest.mark.parametrize("name", LINES)
def test_the_line_runs_down_the_middle_of_the_picture_with_the_tool_above_it(name):
    line = LINES[name]
    tip = tuple(np.array(line.entry) - 0.03 * np.array(line.direction))
    pose = across_line(EYE, line, tip)
    for point in (tip, line.entry, line.target):
        assert in_picture(pose, point)[0] == pytest.approx(0.0, abs=1e-9)
    heights = [in_picture(pose, point)[1] for point in (tip, line.entry, line.target)]
    assert 1.0 > heights[0] > heights[1] > heights[2] > -1.0


@pytest.mark.parametrize("name", LINES)
def test_the_line_is_viewed_from_the_trainees_side(name):
    line = LINES[name]
    pose = across_line(EYE, line, line.entry)
    away = np.array(pose.position) - pose.focal_point
    assert np.linalg.norm(away) == pytest.approx(AWAY_M)
    assert away @ np.array(line.direction) == pytest.approx(0.0, abs=1e-9)
    assert away @ (np.array(EYE) - pose.focal_point) >= 0.0


def test_a_faraway_tool_does_not_shrink_the_line_beyond_visibility():
    pose = across_line(EYE, LINES["sloping"], (1.5, 1.5, 1.5))
    shown = 2.0 * AWAY_M * math.tan(math.radians(pose.view_angle_deg) / 2.0)
    assert shown == pytest.approx(TALLEST_M)


def test_the_view_along_the_skin_widens_the_farther_the_tip_is():
    fiducial, eye = (0.5, 0.1, 0.25), (0.72, 0.1, 0.25)
    near, far, farther = (
        along_skin(eye, fiducial, (0.5, 0.1 + away, 0.25)) for away in (0.0, 0.1, 5.0)
    )
    assert near.view_angle_deg < far.view_angle_deg < farther.view_angle_deg < 90.0
    assert near.view_up == UP
    assert (near.position, near.focal_point) == (eye, fiducial)
