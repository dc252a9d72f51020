"""The view that is turned by hand, or moves to a position by itself."""

import math

import numpy as np
import pytest

from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.viewpoint.view_control import (
    FARTHEST_M,
    HIGHEST_DEG,
    LOWEST_DEG,
    NEAREST_M,
    STILL,
    Orbit,
    ViewControl,
    camera_pose,
    limited,
    orbit_to,
)

EYE, FIDUCIAL = (0.55, 0.4, 0.35), (0.5, 0.1, 0.25)


@pytest.fixture(params=["close-up", "far"])
def camera(scenario, request):
    return scenario.cameras[request.param]


def test_an_unturned_view_is_the_scenarios_camera_bit_for_bit(camera):
    pose = camera_pose(camera)
    assert pose.position == tuple((camera.position_mm / MM_PER_M).tolist())
    assert pose.focal_point == tuple((camera.focal_point_mm / MM_PER_M).tolist())
    assert pose.view_angle_deg == camera.view_angle_deg


def test_an_orbit_reaches_the_eye_position_it_was_made_for(camera):
    pose = camera_pose(camera, orbit_to(camera, EYE, FIDUCIAL))
    np.testing.assert_allclose(pose.position, EYE, atol=1e-12)
    np.testing.assert_allclose(pose.focal_point, FIDUCIAL, atol=1e-12)


def test_no_turn_goes_under_the_table_overhead_into_the_head_or_out_of_the_room(camera):
    for orbit in (Orbit(elevation_deg=-180.0, zoom=1e-6), Orbit(elevation_deg=180.0, zoom=1e6)):
        pose = camera_pose(camera, limited(camera, orbit))
        line = np.subtract(pose.position, pose.focal_point)
        away = np.linalg.norm(line)
        assert NEAREST_M - 1e-9 <= away <= FARTHEST_M + 1e-9
        elevation = math.degrees(math.asin(line[2] / away))
        assert LOWEST_DEG - 1e-9 <= elevation <= HIGHEST_DEG + 1e-9


def test_the_view_moves_smoothly_along_the_shorter_way_and_arrives(scenario):
    camera, control = scenario.cameras["close-up"], ViewControl()
    control.turn(camera, 170.0, 0.0, 1.0)
    goal = Orbit(azimuth_deg=-170.0, zoom=0.5)
    control.go(goal)
    turns = []
    while control.orbit != goal:
        control.advance(0.02, camera, STILL, is_arm_still=False)
        turns.append(math.remainder(control.orbit.azimuth_deg - 170.0, 360.0))
    assert turns == sorted(turns)
    assert max(np.diff(turns)) < 3.0
    assert turns[-1] == pytest.approx(20.0)
