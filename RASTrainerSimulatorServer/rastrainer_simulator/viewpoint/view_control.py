"""The view as it is now: turned by hand, or on its way to where a touch is seen best."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from rastrainer.scenario.scenario import Camera
from rastrainer_simulator.vectors import Vector, length, subtract
from rastrainer_simulator.viewpoint.orbit import FRONT, CameraPose, Orbit, camera_pose, limited

TURN_DEG_S = 70.0
RISE_DEG_S = 45.0
ZOOM_PER_S = 2.0
"""How fast held buttons move the view."""
TRAVEL_DEG_S = 110.0
SHORTEST_S = 0.5
"""How fast the view goes to another place by itself, and how long it takes at least."""


@dataclass(frozen=True)
class ViewMotion:
    """What is held to move the view, −1…1 each: around to the right, higher, nearer."""

    around: float = 0.0
    higher: float = 0.0
    nearer: float = 0.0


STILL = ViewMotion()


@dataclass
class _Travel:
    """A way from one orbit to another, `share` of which is done."""

    start: Orbit
    goal: Orbit
    seconds: float
    is_automatic: bool
    share: float = 0.0


@dataclass(frozen=True)
class Pictures:
    """What the views draw: the main picture's camera, and that of the inset.

    The inset looks along the skin at the next touch, or across the line of a procedure; it is None
    where there is neither. `yaw_deg` is where the operator's eyes look,
    degrees from World's x, in a headset; else None.
    """

    main: CameraPose
    inset: CameraPose | None = None
    yaw_deg: float | None = None


class ViewControl:
    """One view of the scene, which all windows and pages draw.

    Attributes:
        camera: the scenario's camera that it starts from.
        orbit: how it differs from that.
        is_automatic: whether the last change of place was by itself.
    """

    def __init__(self) -> None:
        self.camera = ""
        self.orbit = FRONT
        self.is_automatic = False
        self._travel: _Travel | None = None

    @property
    def is_moved(self) -> bool:
        """Whether it is, or will be, elsewhere than the scenario's camera."""
        travel = self._travel
        return (self.orbit if travel is None else travel.goal) != FRONT

    @property
    def is_traveling(self) -> bool:
        """Whether it is on its way to another place."""
        return self._travel is not None

    def use(self, camera: str) -> None:
        """Start from a camera of the scenario, unless it is the one already."""
        if camera != self.camera:
            self.camera = camera
            self.reset()

    def reset(self) -> None:
        """Be the scenario's camera again."""
        self.orbit, self._travel, self.is_automatic = FRONT, None, False

    def turn(self, camera: Camera, around_deg: float, higher_deg: float, zoom: float) -> None:
        """Turn the view by hand, at once; `zoom` multiplies its distance."""
        if (around_deg, higher_deg, zoom) == (0.0, 0.0, 1.0):
            return
        self._travel, self.is_automatic = None, False
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
        """Go to another place, gently."""
        turn = math.remainder(goal.azimuth_deg - self.orbit.azimuth_deg, 360.0)
        degrees = math.hypot(turn, goal.elevation_deg - self.orbit.elevation_deg)
        seconds = max(SHORTEST_S, degrees / TRAVEL_DEG_S)
        if self.orbit != goal:
            self._travel = _Travel(self.orbit, goal, seconds, is_automatic)

    def advance(self, dt: float, camera: Camera, motion: ViewMotion, is_arm_still: bool) -> None:
        """Move on by `dt` seconds: by what is held, else on the way.

        A way that was set out on automatically waits while the arm is driven.
        """
        if motion != STILL:
            zoom = ZOOM_PER_S ** (-motion.nearer * dt)
            around, higher = motion.around * TURN_DEG_S * dt, motion.higher * RISE_DEG_S * dt
            self.turn(camera, around, higher, zoom)
            return
        travel = self._travel
        if travel is None or (travel.is_automatic and not is_arm_still):
            return
        travel.share = min(1.0, travel.share + dt / travel.seconds)
        self.is_automatic = travel.is_automatic
        if travel.share < 1.0:
            gentle = travel.share**2 * (3.0 - 2.0 * travel.share)
            self.orbit = travel.start.toward(travel.goal, gentle)
        else:
            self.orbit, self._travel = travel.goal, None

    def pose(self, camera: Camera) -> CameraPose:
        """Return where the picture's camera stands; `camera` is the scenario's of that name."""
        return camera_pose(camera, self.orbit)


BESIDE_HEIGHT_M = (0.07, 0.3)
"""The least and the greatest height of what the picture along the skin shows."""


def along_skin(eye: Vector, fiducial: Vector, normal: Vector, tip: Vector) -> CameraPose:
    """Return the camera that looks along the skin at a fiducial, the skin level in its picture.

    It shows the more the farther the tip is, up to a limit; World, m.
    """
    least, most = BESIDE_HEIGHT_M
    height = min(max(2.4 * length(subtract(tip, fiducial)), least), most)
    away = length(subtract(eye, fiducial))
    angle_deg = math.degrees(2.0 * math.atan(0.5 * height / away))
    return CameraPose(eye, fiducial, normal, angle_deg)
