"""What guides the trainee on the skin: dots, rims, numbers and arrows that follow its curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from rastrainer.head_mesh import HeadMesh
from rastrainer_simulator.scene.arrows import LENGTHS, arrow_shape, arrows
from rastrainer_simulator.scene.mark_shapes import dot, number, rim
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


def skin_marks(head: HeadMesh, points: np.ndarray, labels: Sequence[str]) -> list[SkinMark]:
    """Return the marks of fiducials at `points` (n, 3) float, RAS mm, in the order to touch."""
    skin = Skin(head)
    numbers = [number(label) for label in labels]
    sizes = [np.ptp(flat, axis=0) for flat, _ in numbers]
    for longest in LENGTHS:
        ways = arrows(skin, points, longest)
        places, has_room = number_places(skin, points, sizes, ways)
        if has_room:
            break
    ribbons = [
        _lifted(arrow_shape(skin, way), ARROW_LIFT) if way.is_drawn else None for way in ways
    ]
    marks = []
    for index, (point, label) in enumerate(zip(points, labels, strict=True)):
        marks.append(
            SkinMark(
                label,
                _lifted(skin.lay_shape(*dot(), point), DOT_LIFT),
                _lifted(skin.lay_shape(*rim(), point), RIM_LIFT),
                _lifted(skin.lay_shape(*numbers[index], places[index]), NUMBER_LIFT),
                ribbons[index] if index < len(ribbons) else None,
            )
        )
    return marks


def _lifted(shape: Shape, lift: float) -> Shape:
    return Shape(shape.points + lift * shape.outward, shape.triangles, shape.outward)
