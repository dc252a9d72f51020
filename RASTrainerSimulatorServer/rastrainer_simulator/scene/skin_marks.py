"""The trainee's guides on the skin: dots, rims, numbers and arrows that follow its curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.head.mesh import HeadMesh
from rastrainer_simulator.scene.skin import (
    DOT_RADIUS,
    LENGTHS,
    RIM_RADIUS,
    Arrow,
    Flat,
    Shape,
    Skin,
    arrow_shape,
    arrows,
    disk,
    number,
)

DISTANCES = (11.5, 13.0, 15.0, 17.5, 20.5, 24.0)
ANGLES = np.radians(np.arange(0, 360, 20))
MARGINS = (2.5, 1.5)
"""How far a number keeps from everything else, mm: the most that is possible for all."""
NUMBERS_APART = 3.0
"""How many times that margin two numbers keep from each other: 5 next to 2 must not read 52."""
OWN_SHARE = 0.8
"""Largest ratio of a number's distance to its own dot and to any other, so that it is clear."""
ENOUGH = 16
"""Candidate positions, after which none farther from the fiducial is considered."""
MAX_TRIES = 20_000
_COLUMNS, _ROWS = 7, 5
_RELIEF = 0.3
_ROOM_ENOUGH = 6.0


@dataclass(frozen=True)
class Place:
    """One possible position of a number, its middle (3,) on the skin.

    `covers` (k, 3) are places all over its rectangle, with the clearance to arrows and rims;
    `cost` is how much worse it is than the best place there could be, mm.
    """

    middle: np.ndarray
    covers: np.ndarray
    clearance: float
    cost: float


def _number_places(
    skin: Skin, points: np.ndarray, sizes: Sequence[np.ndarray], arrows: Sequence[Arrow]
) -> tuple[list[np.ndarray], bool]:
    """Return the middle (3,) of each number, and whether all keep at least the least margin.

    `points` (n, 3) float are the fiducials; `sizes` the width and height (2,) of each number, mm.
    If not all numbers can keep the margin, each goes where it has the most room, if any.
    """
    samples = [arrow.samples() for arrow in arrows]
    obstacles = np.concatenate([points, *(places for places, _ in samples)])
    radii = np.concatenate([np.full(len(points), RIM_RADIUS), *(widths for _, widths in samples)])
    choices = [
        _choices(skin, points, index, size, obstacles, radii) for index, size in enumerate(sizes)
    ]
    for margin in MARGINS:
        chosen = _chosen(choices, margin)
        if chosen is not None:
            return [place.middle for place in chosen], True
    roomiest = [
        max(places, key=lambda place: place.clearance).middle if places else point
        for places, point in zip(choices, points, strict=True)
    ]
    return roomiest, False


def _choices(
    skin: Skin,
    points: np.ndarray,
    index: int,
    size: np.ndarray,
    obstacles: np.ndarray,
    radii: np.ndarray,
) -> list[Place]:
    """Return positions around one fiducial, best first; as far out as it takes to have enough."""
    point = points[index]
    frame = skin.frame(point)
    others = np.delete(points, index, axis=0)
    near = np.linalg.norm(obstacles - point, axis=1) < 80.0
    obstacles, radii = obstacles[near], radii[near]
    least = size.min() / 2.0 + MARGINS[-1]
    across, upward = (
        np.linspace(-length / 2.0, length / 2.0, count)
        for length, count in zip(size, (_COLUMNS, _ROWS), strict=True)
    )
    rectangle = np.stack(np.meshgrid(across, upward), axis=-1).reshape(-1, 2)
    around = np.column_stack([np.cos(ANGLES), np.sin(ANGLES)]) @ frame[:2]
    places: list[Place] = []
    for distance in DISTANCES:
        for middle in skin.onto(point + distance * around, frame[2]):
            own = np.linalg.norm(middle - point)
            if own > OWN_SHARE * np.linalg.norm(others - middle, axis=1).min(initial=np.inf):
                continue
            if _clearance(middle[None], obstacles, radii) < least:
                continue
            covers = skin.lay(rectangle, middle)
            clearance = _clearance(covers, obstacles, radii)
            relief = float(np.ptp((covers - middle) @ frame[2]))
            crowded = max(0.0, _ROOM_ENOUGH - clearance)
            cost = distance - DISTANCES[0] + _RELIEF * relief + crowded
            places.append(Place(middle, covers, clearance, cost))
        if sum(place.clearance >= MARGINS[0] for place in places) >= ENOUGH:
            break
    return sorted(places, key=lambda place: place.cost)


def _clearance(covers: np.ndarray, obstacles: np.ndarray, radii: np.ndarray) -> float:
    away = covers[:, None] - obstacles[None]
    return float((np.sqrt(np.einsum("ijk,ijk->ij", away, away)) - radii).min())


def _chosen(choices: list[list[Place]], margin: float) -> list[Place] | None:
    """Choose a position for each number so that all keep the margin; fewest choices first."""
    allowed = [[place for place in places if place.clearance >= margin] for places in choices]
    order = sorted(range(len(choices)), key=lambda index: len(allowed[index]))
    chosen: dict[int, Place] = {}
    tries = 0

    def choose(depth: int) -> bool:
        nonlocal tries
        if depth == len(order):
            return True
        for place in allowed[order[depth]]:
            tries += 1
            if tries > MAX_TRIES:
                return False
            if all(_apart(place, other) >= NUMBERS_APART * margin for other in chosen.values()):
                chosen[order[depth]] = place
                if choose(depth + 1):
                    return True
                del chosen[order[depth]]
        return False

    return [chosen[index] for index in range(len(choices))] if choose(0) else None


def _apart(first: Place, second: Place) -> float:
    """Return the distance of two numbers' rectangles."""
    if np.linalg.norm(first.middle - second.middle) > 60.0:
        return np.inf
    return float(np.linalg.norm(first.covers[:, None] - second.covers[None], axis=2).min())


ARROW_LIFT, RIM_LIFT, NUMBER_LIFT, DOT_LIFT = 0.5, 0.5, 0.6, 0.8
"""How far each is above the skin, mm, so that no wrinkle hides it."""


@dataclass(frozen=True)
class SkinMark:
    """One fiducial's marks, in the head's frame, RAS mm; the last has no arrow."""

    label: str
    dot: Shape
    rim: Shape
    number: Shape
    arrow: Shape | None


@dataclass(frozen=True)
class Placement:
    """The marks of a task: each number as a flat shape and its middle (3,), RAS mm, and the arrows.

    `has_room` is whether all numbers keep clear of arrows, rims and each other.
    """

    numbers: list[Flat]
    places: list[np.ndarray]
    arrows: list[Arrow]
    has_room: bool


def place_marks(skin: Skin, points: np.ndarray, labels: Sequence[str]) -> Placement:
    """Return where numbers and arrows go, the arrows as long as the numbers leave room."""
    numbers = [number(label) for label in labels]
    sizes = [np.ptp(flat, axis=0) for flat, _ in numbers]
    for longest in LENGTHS:
        placed_arrows = arrows(skin, points, longest)
        places, has_room = _number_places(skin, points, sizes, placed_arrows)
        if has_room:
            break
    return Placement(numbers, places, placed_arrows, has_room)


def skin_marks(head: HeadMesh, points: np.ndarray, labels: Sequence[str]) -> list[SkinMark]:
    """Return the marks of fiducials at `points` (n, 3) float, RAS mm, in the order to touch."""
    skin = Skin(head)
    placed = place_marks(skin, points, labels)
    ribbons: list[Shape | None] = [
        _lifted(arrow_shape(skin, arrow), ARROW_LIFT) if arrow.end > arrow.start else None
        for arrow in placed.arrows
    ]
    numbers = zip(placed.numbers, placed.places, strict=True)
    return [
        SkinMark(
            label,
            _lifted(skin.lay_shape(*disk(0.0, DOT_RADIUS), point), DOT_LIFT),
            _lifted(skin.lay_shape(*disk(DOT_RADIUS - 0.4, RIM_RADIUS), point), RIM_LIFT),
            _lifted(skin.lay_shape(*flat, place), NUMBER_LIFT),
            ribbon,
        )
        for point, label, (flat, place), ribbon in zip(
            points, labels, numbers, [*ribbons, None], strict=True
        )
    ]


def _lifted(shape: Shape, lift: float) -> Shape:
    return Shape(shape.points + lift * shape.outward, shape.triangles, shape.outward)
