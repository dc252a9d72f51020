"""A view that has been turned about what it looks at, and where its camera then stands."""

from __future__ import annotations

import math
from dataclasses import dataclass

from rastrainer.scenario.scenario import Camera
from rastrainer_simulator.teleoperation.axes import camera_axes
from rastrainer_simulator.vectors import (
    ZERO,
    Vector,
    add,
    in_meters,
    length,
    scale,
    subtract,
    vector,
)

LOWEST_DEG, HIGHEST_DEG = -15.0, 85.0
"""How far below and above its focal point a turned camera may stand, seen from there."""
NEAREST_M, FARTHEST_M = 0.2, 2.6
"""From a turned camera to its focal point: never in the head, never behind a wall."""


@dataclass(frozen=True)
class CameraPose:
    """Where a camera stands: World, m.

    Attributes:
        position: the eye.
        focal_point: what is in the middle of the picture.
        view_up: unit vector.
        angle_deg: the picture's height as an angle.
    """

    position: Vector
    focal_point: Vector
    view_up: Vector
    angle_deg: float


@dataclass(frozen=True)
class Orbit:
    """By how much a view differs from a camera of the scenario.

    Attributes:
        azimuth_deg: turn about World's vertical, counterclockwise from above.
        elevation_deg: how much higher the camera stands, as an angle.
        zoom: its distance, as a share of the scenario camera's.
        shift: of the focal point, World, m.
    """

    azimuth_deg: float = 0.0
    elevation_deg: float = 0.0
    zoom: float = 1.0
    shift: Vector = ZERO

    def toward(self, other: Orbit, share: float) -> Orbit:
        """Return an orbit between this and another, the shorter way around."""
        turn = math.remainder(other.azimuth_deg - self.azimuth_deg, 360.0)
        rise = other.elevation_deg - self.elevation_deg
        way = subtract(other.shift, self.shift)
        return Orbit(
            self.azimuth_deg + share * turn,
            self.elevation_deg + share * rise,
            self.zoom * (other.zoom / self.zoom) ** share,
            add(self.shift, scale(way, share)),
        )


FRONT = Orbit()
"""The scenario's camera itself."""


@dataclass(frozen=True)
class _Place:
    """A camera of a scenario in spherical coordinates about its focal point; m, rad."""

    focal_point: Vector
    azimuth: float
    elevation: float
    distance: float


def camera_pose(camera: Camera, orbit: Orbit = FRONT) -> CameraPose:
    """Return where a scenario's camera stands once it is turned."""
    if orbit == FRONT:
        position, focal_point = in_meters(camera.position), in_meters(camera.focal_point)
        up = vector(camera.view_up.tolist())
        return CameraPose(position, focal_point, up, camera.view_angle_deg)
    place = _place(camera)
    focal_point = add(place.focal_point, orbit.shift)
    azimuth = place.azimuth + math.radians(orbit.azimuth_deg)
    elevation = place.elevation + math.radians(orbit.elevation_deg)
    away = place.distance * orbit.zoom
    level = away * math.cos(elevation)
    offset = (level * math.cos(azimuth), level * math.sin(azimuth), away * math.sin(elevation))
    return CameraPose(add(focal_point, offset), focal_point, (0.0, 0.0, 1.0), camera.view_angle_deg)


def orbit_to(camera: Camera, eye: Vector, focal_point: Vector) -> Orbit:
    """Return the orbit that brings a scenario's camera to `eye`, looking at a point; World, m."""
    place = _place(camera)
    line = subtract(eye, focal_point)
    away = length(line)
    turn = math.degrees(math.atan2(line[1], line[0]) - place.azimuth)
    return limited(
        camera,
        Orbit(
            math.remainder(turn, 360.0),
            math.degrees(math.asin(line[2] / away) - place.elevation),
            away / place.distance,
            subtract(focal_point, place.focal_point),
        ),
    )


def limited(camera: Camera, orbit: Orbit) -> Orbit:
    """Return an orbit whose camera is neither too low nor too high, too near nor too far."""
    place = _place(camera)
    base = math.degrees(place.elevation)
    # A scenario's own camera may stand beyond the limits: then it is the limit.
    lowest, highest = min(LOWEST_DEG, base), max(HIGHEST_DEG, base)
    nearest, farthest = min(NEAREST_M, place.distance), max(FARTHEST_M, place.distance)
    return Orbit(
        math.remainder(orbit.azimuth_deg, 360.0),
        min(max(base + orbit.elevation_deg, lowest), highest) - base,
        min(max(orbit.zoom * place.distance, nearest), farthest) / place.distance,
        orbit.shift,
    )


def heading_deg(camera: Camera) -> float:
    """Return where forward points in a scenario camera's picture, degrees from World's x."""
    return math.degrees(_place(camera).azimuth + math.pi)


def _place(camera: Camera) -> _Place:
    position, focal_point = in_meters(camera.position), in_meters(camera.focal_point)
    line = subtract(position, focal_point)
    away = length(line)
    forward = camera_axes(scale(line, -1.0), vector(camera.view_up.tolist())).forward
    azimuth = math.atan2(-forward[1], -forward[0])
    return _Place(focal_point, azimuth, math.asin(line[2] / away), away)
