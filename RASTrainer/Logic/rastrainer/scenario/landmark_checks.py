"""Whether a head's landmarks can be used: how many, on the skin, on the right side, spread."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from rastrainer.head.mesh import HeadMesh, nearest_on_mesh
from rastrainer.protocol import COARSE_LANDMARKS
from rastrainer.scenario.tasks import MAX_LANDMARKS, Landmark

NASION, NOSE_TIP = "Nasion", "Tip of the nose"
FACE_LANDMARKS = (
    NASION,
    "Right outer canthus",
    "Left outer canthus",
    "Right inner canthus",
    "Left inner canthus",
    "Right tragus",
    "Left tragus",
    NOSE_TIP,
)
"""The usual ones; right and left are the patient's."""
SNAP_MM = 5.0
"""A landmark nearer to the skin than this is moved onto it; one farther off is wrong."""
APART_MM = 10.0
"""Least distance of two landmarks."""
LEAST_SPREAD_MM = 15.0
"""Least distance of the first three landmarks from the line that fits them best, RMS times √3."""
ASIDE_MM = 3.0
"""How far a landmark of one side may be beyond the middle of the head."""
_SIDES = {"right": 1.0, "left": -1.0}


def on_skin(mesh: HeadMesh, landmarks: Sequence[Landmark]) -> tuple[Landmark, ...]:
    """Return landmarks with those near the skin moved onto it; others stay where they are."""
    moved = []
    for landmark in landmarks:
        nearest = nearest_on_mesh(mesh, landmark.position)
        is_near = nearest.distance <= SNAP_MM
        place = nearest.position.round(2) if is_near else landmark.position
        moved.append(Landmark(landmark.name, place))
    return tuple(moved)


def check_landmarks(mesh: HeadMesh, landmarks: Sequence[Landmark]) -> list[str]:
    """Return a sentence for each thing that is wrong with the landmarks of a head."""
    if not COARSE_LANDMARKS <= len(landmarks) <= MAX_LANDMARKS:
        return [
            f"The head has {len(landmarks)} landmarks; place {COARSE_LANDMARKS} to "
            f"{MAX_LANDMARKS} of them."
        ]
    return [
        *_named_twice(landmarks),
        *_off_skin(mesh, landmarks),
        *_on_other_side(mesh, landmarks),
        *_close(landmarks),
        *_in_line(landmarks[:COARSE_LANDMARKS]),
    ]


def spread_first(landmarks: Sequence[Landmark]) -> tuple[Landmark, ...]:
    """Return landmarks in an order whose first three enclose the largest triangle.

    They are the coarse start of a trace. The others follow as they were.
    """
    if len(landmarks) <= COARSE_LANDMARKS:
        return tuple(landmarks)
    first = max(combinations(landmarks, COARSE_LANDMARKS), key=_area)
    names = {landmark.name for landmark in first}
    return (*first, *(each for each in landmarks if each.name not in names))


def _area(three: Sequence[Landmark]) -> float:
    a, b, c = (landmark.position for landmark in three)
    return float(np.linalg.norm(np.cross(b - a, c - a)))


def _named_twice(landmarks: Sequence[Landmark]) -> list[str]:
    names = [landmark.name for landmark in landmarks]
    twice = [name for name in dict.fromkeys(names) if names.count(name) > 1]
    return [f"{name} is placed {names.count(name)} times; keep one." for name in twice]


def _off_skin(mesh: HeadMesh, landmarks: Sequence[Landmark]) -> list[str]:
    wrong = []
    for landmark in landmarks:
        away = nearest_on_mesh(mesh, landmark.position).distance
        if away > SNAP_MM:
            wrong.append(
                f"{landmark.name} is {away:.0f} mm off the skin; place it within {SNAP_MM:g} mm."
            )
    return wrong


def _on_other_side(mesh: HeadMesh, landmarks: Sequence[Landmark]) -> list[str]:
    """Return which landmarks are on the other side than their names say; +R is the right."""
    places = {landmark.name: landmark.position for landmark in landmarks}
    middle = float((mesh.vertices[:, 0].max() + mesh.vertices[:, 0].min()) / 2.0)
    swapped, wrong = [], []
    for name, place in places.items():
        side, _, rest = name.partition(" ")
        sign = _SIDES.get(side.lower())
        if sign is None or sign * (place[0] - middle) > -ASIDE_MM:
            continue
        other = next((n for n in places if n.lower() == f"{_OTHER[side.lower()]} {rest}"), None)
        if other is None or -sign * (places[other][0] - middle) > -ASIDE_MM:
            wrong.append(
                f"{name} is on the patient's {_OTHER[side.lower()]}; R is positive on the right."
            )
        elif other not in swapped:
            swapped.append(name)
            wrong.append(f"{name} and {other} are swapped; R is positive on the patient's right.")
    return wrong


_OTHER = {"right": "left", "left": "right"}


def _close(landmarks: Sequence[Landmark]) -> list[str]:
    wrong = []
    for one, other in combinations(landmarks, 2):
        apart = float(np.linalg.norm(one.position - other.position))
        if apart < APART_MM and one.name != other.name:
            wrong.append(
                f"{one.name} and {other.name} are {apart:.1f} mm apart; landmarks must be "
                f"{APART_MM:g} mm apart."
            )
    return wrong


def _in_line(three: Sequence[Landmark]) -> list[str]:
    places = np.array([landmark.position for landmark in three], dtype=float)
    spread = np.linalg.svd(places - places.mean(axis=0), compute_uv=False)[1]
    if spread >= LEAST_SPREAD_MM:
        return []
    names = ", ".join(landmark.name for landmark in three)
    return [
        f"The first three landmarks ({names}) are almost in a line, which leaves the head free to "
        "turn about it; let three that are spread come first."
    ]
