"""The inset across a procedure's planned line."""

import math

import numpy as np
import pytest

from rastrainer_simulator.trial_state import PlannedLine
from rastrainer_simulator.viewpoint.trial_view import AWAY_M, across_line

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
def test_the_line_runs_down_the_picture_seen_from_the_trainees_side(name):
    line = LINES[name]
    tip = tuple(np.array(line.entry) - 0.03 * np.array(line.direction))
    pose = across_line(EYE, line, tip)
    seen = [in_picture(pose, point) for point in (tip, line.entry, line.target)]
    assert [right for right, _up in seen] == pytest.approx([0.0] * 3, abs=1e-9)
    heights = [up for _right, up in seen]
    assert 1.0 > heights[0] > heights[1] > heights[2] > -1.0
    away = np.array(pose.position) - pose.focal_point
    assert np.linalg.norm(away) == pytest.approx(AWAY_M)
    assert away @ (np.array(EYE) - pose.focal_point) >= 0.0
