"""The view as it is now, turned by hand or on its way; and how a planned line lies in it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated

from rastrainer.json_checks import number
from rastrainer.scenario.scenario import Camera
from rastrainer_simulator.teleoperation.steering import camera_axes
from rastrainer_simulator.trial_state import GuideAxis, PlannedLine
from rastrainer_simulator.vectors import (
    ZERO,
    RecordVector,
    Vector,
    add,
    cross,
    dot,
    in_meters,
    length,
    reject,
    scale,
    subtract,
    unit,
    vector,
)

LOWEST_DEG, HIGHEST_DEG = -15.0, 85.0
"""How far below and above its focal point a turned camera may stand, seen from there."""
NEAREST_M, FARTHEST_M = 0.2, 2.6
"""Distances of a turned camera from its focal point: never in the head, never behind a wall."""
UP: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class CameraPose:
    """Where a camera stands, World, m; the focal point is in the middle of its picture.

    `view_up` is a unit vector, `view_angle_deg` the picture's height as an angle.
    """

    position: RecordVector
    focal_point: RecordVector
    view_up: RecordVector
    view_angle_deg: Annotated[float, number(0, 180, "degrees")]


@dataclass(frozen=True)
class Orbit:
    """The difference of a view from a camera of the scenario.

    It is turned about World's vertical, counterclockwise from above, stands higher by an angle, its
    distance is a share (`zoom`) of the other's, and its focal point is shifted (World, m).
    """

    azimuth_deg: float = 0.0
    elevation_deg: float = 0.0
    zoom: float = 1.0
    shift: Vector = ZERO

    def toward(self, other: Orbit, share: float) -> Orbit:
        """Return an orbit between this and another, in the shorter direction."""
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
        position, focal_point = in_meters(camera.position_mm), in_meters(camera.focal_point_mm)
        up = vector(camera.view_up.tolist())
        return CameraPose(position, focal_point, up, camera.view_angle_deg)
    place = _place(camera)
    focal_point = add(place.focal_point, orbit.shift)
    azimuth = place.azimuth + math.radians(orbit.azimuth_deg)
    elevation = place.elevation + math.radians(orbit.elevation_deg)
    away = place.distance * orbit.zoom
    level = away * math.cos(elevation)
    offset = (level * math.cos(azimuth), level * math.sin(azimuth), away * math.sin(elevation))
    return CameraPose(add(focal_point, offset), focal_point, UP, camera.view_angle_deg)


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


def orbit_beside(camera: Camera, place: Vector, outward: Vector, away: float) -> Orbit:
    """Return the orbit that looks at a place on the skin from a distance; World, m.

    Its eye is between the skin's normal, along which the tool hides the tip, and the camera.
    """
    line = subtract(in_meters(camera.position_mm), place)
    between = unit(add(unit(outward), unit(line)))
    return orbit_to(camera, add(place, scale(between, away)), place)


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
    position, focal_point = in_meters(camera.position_mm), in_meters(camera.focal_point_mm)
    line = subtract(position, focal_point)
    away = length(line)
    forward = camera_axes(scale(line, -1.0), vector(camera.view_up.tolist())).forward
    azimuth = math.atan2(-forward[1], -forward[0])
    return _Place(focal_point, azimuth, math.asin(line[2] / away), away)


TURN_DEG_S = 70.0
RISE_DEG_S = 45.0
ZOOM_PER_S = 2.0
"""How fast held buttons move the view."""
TRAVEL_DEG_S = 110.0
SHORTEST_S = 0.5
"""How fast the view moves to another position by itself, and how long it takes at least."""


STILL: Vector = (0.0, 0.0, 0.0)
"""Nothing is held to move the view around to the right, higher or nearer, −1…1 each."""


@dataclass
class _Travel:
    """A move from one orbit to another, `share` of which is done."""

    start: Orbit
    goal: Orbit
    seconds: float
    is_automatic: bool
    share: float = 0.0


@dataclass(frozen=True)
class Pictures:
    """The cameras of the views: the main picture's and the inset's.

    The inset looks along the skin at the next touch, or across the line of a procedure, if any.
    `yaw_deg` is where the operator's eyes look in a headset, degrees from World's x; else None.
    """

    main: CameraPose
    inset: CameraPose | None = None
    yaw_deg: float | None = None


@dataclass(eq=False)
class ViewControl:
    """One view of the scene, which all windows and pages draw: an orbit from a scenario's camera.

    `travel` is a move under way; `is_automatic` is whether the last move was automatic.
    """

    camera: str = ""
    orbit: Orbit = FRONT
    is_automatic: bool = False
    travel: _Travel | None = None

    @property
    def is_moved(self) -> bool:
        """Whether it differs, or will differ, from the scenario's camera."""
        travel = self.travel
        return (self.orbit if travel is None else travel.goal) != FRONT

    def use(self, camera: str) -> None:
        if camera != self.camera:
            self.camera = camera
            self.reset()

    def reset(self) -> None:
        self.orbit, self.travel, self.is_automatic = FRONT, None, False

    def turn(self, camera: Camera, around_deg: float, higher_deg: float, zoom: float) -> None:
        """Turn the view by hand, at once; `zoom` multiplies its distance."""
        if (around_deg, higher_deg, zoom) == (0.0, 0.0, 1.0):
            return
        self.travel, self.is_automatic = None, False
        orbit = self.orbit
        self.orbit = limited(
            camera,
            replace(
                orbit,
                azimuth_deg=orbit.azimuth_deg + around_deg,
                elevation_deg=orbit.elevation_deg + higher_deg,
                zoom=orbit.zoom * zoom,
            ),
        )

    def go(self, goal: Orbit, is_automatic: bool = False) -> None:
        """Move gently to another orbit."""
        turn = math.remainder(goal.azimuth_deg - self.orbit.azimuth_deg, 360.0)
        degrees = math.hypot(turn, goal.elevation_deg - self.orbit.elevation_deg)
        seconds = max(SHORTEST_S, degrees / TRAVEL_DEG_S)
        if self.orbit != goal:
            self.travel = _Travel(self.orbit, goal, seconds, is_automatic)

    def advance(self, dt: float, camera: Camera, motion: Vector, is_arm_still: bool) -> None:
        """Advance by `dt` seconds with the held buttons, else along the move.

        An automatic move waits while the arm is driven.
        """
        if motion != STILL:
            around, higher, nearer = motion
            zoom = ZOOM_PER_S ** (-nearer * dt)
            self.turn(camera, around * TURN_DEG_S * dt, higher * RISE_DEG_S * dt, zoom)
            return
        travel = self.travel
        if travel is None or (travel.is_automatic and not is_arm_still):
            return
        travel.share = min(1.0, travel.share + dt / travel.seconds)
        self.is_automatic = travel.is_automatic
        if travel.share < 1.0:
            gentle = travel.share**2 * (3.0 - 2.0 * travel.share)
            self.orbit = travel.start.toward(travel.goal, gentle)
        else:
            self.orbit, self.travel = travel.goal, None


SIDEWAYS = 0.2
"""Sine of the angle between the guide and the picture's right, below which up decides."""


def aim(
    guide: GuideAxis, line: PlannedLine, pictures: Pictures
) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the offsets of a line's entry and target from the guide's axis: right and up, m.

    Right is the right of the main picture, or of the eyes in a headset. Up is across both.
    """
    main = pictures.main
    to_the_right = unit(cross(subtract(main.focal_point, main.position), main.view_up))
    upward = main.view_up
    if pictures.yaw_deg is not None:
        yaw = math.radians(pictures.yaw_deg)
        to_the_right, upward = (math.sin(yaw), -math.cos(yaw), 0.0), UP
    across = reject(to_the_right, guide.direction)
    if length(across) < SIDEWAYS:
        across = cross(guide.direction, reject(upward, guide.direction))
    right = unit(across)
    up = cross(right, guide.direction)

    def beside(point: Vector) -> tuple[float, float]:
        offset = subtract(point, guide.tip)
        return dot(offset, right), dot(offset, up)

    return beside(line.entry), beside(line.target)
