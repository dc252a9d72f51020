"""From where a touch is seen best, and from where along the skin: rays, tried in order of merit."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product

from rastrainer_simulator.collision.clearance import LineOfSight
from rastrainer_simulator.vectors import (
    Vector,
    add,
    angle,
    cross,
    dot,
    reject,
    rotated,
    scale,
    subtract,
    unit,
)

WIDEST_DEG = 60.0
"""Between the skin's normal and the line to the eye."""
LEAST_OFF_TOOL_DEG = 20.0
"""Between the tool and that line: more end-on its own holder hides the tip."""
LIKED_DEG = 30.0
"""Between normal and line where place and depth are both judged well."""
LIKED_ELEVATION_DEG = 25.0
AWAY_M = (0.5, 0.38, 0.28)
"""From the eye to the fiducial, the best first."""
ELEVATIONS_DEG = tuple(range(-10, 81, 10))
AZIMUTHS_DEG = tuple(range(0, 360, 10))
MARGINS_M = (0.02, 0.0)
"""Around the links: in a trial the arm stands a little differently than planned."""

BESIDE_M = 0.22
BESIDE_DEG = (82.0, 75.0, 65.0)
"""Between the normal and the line along the skin, the best first."""

OFF_SKIN_M = 0.002
SHAFT_M = 0.012
"""Behind the tip: so much of the tool is seen with it."""


@dataclass(frozen=True)
class ViewedTouch:
    """A touch to be looked at: World, m.

    Attributes:
        fiducial: where the tip will be.
        normal: the skin's outward unit normal there.
        number: the middle of its number on the skin.
        direction: of the tool, unit vector to its tip.
    """

    fiducial: Vector
    normal: Vector
    number: Vector
    direction: Vector

    @property
    def places(self) -> tuple[Vector, Vector, Vector]:
        """What must be seen: target, number and tip."""
        lift = scale(self.normal, OFF_SKIN_M)
        shaft = add(self.fiducial, scale(self.direction, -SHAFT_M))
        return add(self.fiducial, lift), add(self.number, lift), shaft


@dataclass(frozen=True)
class BestView:
    """Where to look at a touch from: World, m.

    Attributes:
        eye: from where target, number and tip are seen.
        fiducial: what is looked at.
        normal: the skin's outward unit normal there.
        beside: an eye that looks along the skin; None where something is always in between.
    """

    eye: Vector
    fiducial: Vector
    normal: Vector
    beside: Vector | None


def best_view(touch: ViewedTouch, sight: LineOfSight, front: Vector) -> BestView | None:
    """Return the best view of a touch; None where none shows it within `WIDEST_DEG`.

    `sight` is that of the arm's posture in the touch, `front` the direction from the head to the
    usual camera: of equal views the one nearer to it is taken.
    """
    for margin in MARGINS_M:
        for eye in _eyes(touch, front):
            if is_seen(touch, sight, eye, margin):
                beside = _beside(touch, sight, eye)
                return BestView(eye, touch.fiducial, touch.normal, beside)
    return None


def is_seen(touch: ViewedTouch, sight: LineOfSight, eye: Vector, margin: float) -> bool:
    """Return whether an eye sees target, number and tip of a touch well enough."""
    line = subtract(eye, touch.fiducial)
    off_tool = angle(line, scale(touch.direction, -1.0))
    return (
        angle(line, touch.normal) <= math.radians(WIDEST_DEG)
        and off_tool >= math.radians(LEAST_OFF_TOOL_DEG)
        and all(sight.is_free(eye, place, margin) for place in touch.places)
        and sight.is_past_tool(eye, touch.places[1])
    )


def _eyes(touch: ViewedTouch, front: Vector) -> list[Vector]:
    """Return the places from which a touch may be looked at, the best first."""
    ranked: list[tuple[float, Vector]] = []
    for elevation, azimuth in product(ELEVATIONS_DEG, AZIMUTHS_DEG):
        line = _direction(azimuth, elevation)
        off_normal = math.degrees(angle(line, touch.normal))
        if off_normal > WIDEST_DEG:
            continue
        cost = abs(off_normal - LIKED_DEG) + 0.5 * abs(elevation - LIKED_ELEVATION_DEG)
        cost += 0.25 * math.degrees(angle(line, front))
        for place, away in enumerate(AWAY_M):
            eye = add(touch.fiducial, scale(line, away))
            ranked.append((cost + 15.0 * place, eye))
    return [eye for _, eye in sorted(ranked)]


def _direction(azimuth_deg: float, elevation_deg: float) -> Vector:
    azimuth, elevation = math.radians(azimuth_deg), math.radians(elevation_deg)
    level = math.cos(elevation)
    return (level * math.cos(azimuth), level * math.sin(azimuth), math.sin(elevation))


def _beside(touch: ViewedTouch, sight: LineOfSight, eye: Vector) -> Vector | None:
    """Return an eye that looks along the skin, across the best view's line as far as possible."""
    target, _number, shaft = touch.places
    for place in _along_skin(touch, eye):
        off_tool = angle(subtract(place, touch.fiducial), scale(touch.direction, -1.0))
        is_side_on = off_tool >= math.radians(LEAST_OFF_TOOL_DEG)
        if is_side_on and sight.is_free(place, target) and sight.is_free(place, shaft):
            return place
    return None


def _along_skin(touch: ViewedTouch, eye: Vector) -> Iterator[Vector]:
    line = subtract(eye, touch.fiducial)
    across = reject(line, touch.normal)
    # Looked at right along the normal, any side is across.
    start = unit(across if dot(across, across) > 1e-9 else reject((0.0, 0.0, 1.0), touch.normal))
    right = cross(touch.normal, start)
    for lean in BESIDE_DEG:
        for turn in sorted(range(-180, 180, 15), key=lambda degrees: abs(abs(degrees) - 0.1)):
            side = rotated(right, touch.normal, math.radians(turn))
            tilt = math.radians(lean)
            raised = add(scale(side, math.sin(tilt)), scale(touch.normal, math.cos(tilt)))
            yield add(touch.fiducial, scale(raised, BESIDE_M))
