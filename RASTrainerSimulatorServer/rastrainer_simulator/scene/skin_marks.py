"""What guides the trainee on the skin: dots, rims, numbers and arrows that follow its curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.head_mesh import HeadMesh
from rastrainer_simulator.scene.arrows import LENGTHS, Arrow, arrow_shape, arrows
from rastrainer_simulator.scene.mark_shapes import Flat, dot, number, rim
from rastrainer_simulator.scene.number_places import number_places
from rastrainer_simulator.scene.skin import Shape, Skin

ARROW_LIFT, RIM_LIFT, NUMBER_LIFT, DOT_LIFT = 0.5, 0.5, 0.6, 0.8
"""How far above the skin each lies, mm, so that no wrinkle hides it."""


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
    """Where the marks of a task stand.

    Attributes:
        numbers: their flat shapes.
        places: (3,) float, RAS mm, the middle of each number.
        ways: the arrows.
        has_room: whether all numbers keep clear of arrows, rims and each other.
    """

    numbers: list[Flat]
    places: list[np.ndarray]
    ways: list[Arrow]
    has_room: bool


def place_marks(skin: Skin, points: np.ndarray, labels: Sequence[str]) -> Placement:
    """Return where numbers and arrows stand, the arrows as long as the numbers leave room."""
    numbers = [number(label) for label in labels]
    sizes = [np.ptp(flat, axis=0) for flat, _ in numbers]
    for longest in LENGTHS:
        ways = arrows(skin, points, longest)
        places, has_room = number_places(skin, points, sizes, ways)
        if has_room:
            break
    return Placement(numbers, places, ways, has_room)


def skin_marks(head: HeadMesh, points: np.ndarray, labels: Sequence[str]) -> list[SkinMark]:
    """Return the marks of fiducials at `points` (n, 3) float, RAS mm, in the order to touch."""
    skin = Skin(head)
    placed = place_marks(skin, points, labels)
    ribbons = [
        _lifted(arrow_shape(skin, way), ARROW_LIFT) if way.is_drawn else None for way in placed.ways
    ]
    marks = []
    for index, (point, label) in enumerate(zip(points, labels, strict=True)):
        marks.append(
            SkinMark(
                label,
                _lifted(skin.lay_shape(*dot(), point), DOT_LIFT),
                _lifted(skin.lay_shape(*rim(), point), RIM_LIFT),
                _lifted(skin.lay_shape(*placed.numbers[index], placed.places[index]), NUMBER_LIFT),
                ribbons[index] if index < len(ribbons) else None,
            )
        )
    return marks


def _lifted(shape: Shape, lift: float) -> Shape:
    return Shape(shape.points + lift * shape.outward, shape.triangles, shape.outward)
