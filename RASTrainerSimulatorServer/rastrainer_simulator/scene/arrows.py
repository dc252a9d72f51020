"""Arrows on the skin, from each fiducial toward the next: ribbons projected step by step."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from rastrainer_simulator.scene.skin import RIM_RADIUS, Shape, Skin

STEP = 2.0
"""Length of a step, after which the ribbon is projected onto the skin again, mm."""
GAP = 1.3
LENGTHS = (26.0, 16.0, 10.0)
"""How long arrows are at most; shorter where else numbers would find no room."""
SHORTEST = 6.0
SHAFT_WIDTH = 2.0
HEAD_WIDTH, HEAD_LENGTH = 5.4, 5.5
APART = 1.5
BERTH = 4.0
"""How wide an arrow passes the rim of a fiducial that it does not lead to."""
TURNS = tuple(np.radians((0.0, 12.0, -12.0, 24.0, -24.0, 36.0, -36.0)))
_ACROSS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])


@dataclass(frozen=True)
class Arrow:
    """The middle line of an arrow; mm, RAS.

    Attributes:
        path: (n, 3) float, on the skin, from the fiducial on, a step apart.
        outward: (n, 3) float, the skin's normals there.
        start: length of the path at which the arrow starts.
        end: and at which its tip is.
    """

    path: np.ndarray
    outward: np.ndarray
    start: float
    end: float

    @property
    def is_drawn(self) -> bool:
        """Whether there is room for it: fiducials may touch each other."""
        return self.end > self.start

    def half_width(self, along: np.ndarray) -> np.ndarray:
        """Return half the arrow's width at lengths of the path (k,)."""
        left = self.end - along
        head = HEAD_WIDTH / 2.0 * np.clip(left / HEAD_LENGTH, 0.0, 1.0)
        return np.where(left <= HEAD_LENGTH, head, SHAFT_WIDTH / 2.0)

    def samples(self) -> tuple[np.ndarray, np.ndarray]:
        """Return places (k, 3) along the arrow, 1 mm apart, and its half widths (k,) there."""
        if not self.is_drawn:
            return np.empty((0, 3)), np.empty(0)
        along = np.linspace(self.start, self.end, max(2, round(self.end - self.start) + 1))
        return _at(self.path, along), self.half_width(along)


def arrows(skin: Skin, points: np.ndarray, longest: float = LENGTHS[0]) -> list[Arrow]:
    """Return the arrows between consecutive `points` (n, 3) float on the skin, to `longest` mm.

    They keep away from all fiducials and from each other, and are shortened where need be.
    """
    made = []
    for index in range(len(points) - 1):
        start, goal = points[index], points[index + 1]
        others = np.delete(points, (index, index + 1), axis=0)
        made.append(_between(skin, start, goal, others, longest))
    return _kept_apart(made)


def arrow_shape(skin: Skin, arrow: Arrow) -> Shape:
    """Return the arrow as a ribbon on the skin: a shaft, and a head that comes to a point."""
    neck = max(arrow.start, arrow.end - HEAD_LENGTH)
    shaft = np.linspace(arrow.start, neck, max(2, round((neck - arrow.start) / STEP) + 1))
    head = np.linspace(neck, arrow.end, 4)
    along = np.concatenate([shaft, head])
    widths = np.concatenate([np.full(len(shaft), SHAFT_WIDTH / 2.0), arrow.half_width(head)])
    middle, outward = _at(arrow.path, along), _unit(_at(arrow.outward, along))
    to_left = _unit(np.cross(outward, _tangents(arrow.path, along)))
    sides = np.array(_ACROSS)[:, None] * (widths[:, None] * to_left)[:, None]
    rows = [
        skin.onto(row, normal) for row, normal in zip(middle[:, None] + sides, outward, strict=True)
    ]
    points = np.concatenate(rows)
    return Shape(points, _grid(len(along), len(_ACROSS)), np.repeat(outward, len(_ACROSS), axis=0))


def _between(
    skin: Skin, start: np.ndarray, goal: np.ndarray, others: np.ndarray, longest: float
) -> Arrow:
    """Return the arrow from one fiducial toward the next, around any of the `others` (k, 3)."""
    best: Arrow | None = None
    for turn in TURNS:
        arrow, is_whole = _turned(skin, start, goal, others, turn, longest)
        if is_whole:
            return arrow
        if best is None or arrow.end > best.end + STEP:
            best = arrow
    assert best is not None  # There is at least one turn.
    return best


def _turned(
    skin: Skin, start: np.ndarray, goal: np.ndarray, others: np.ndarray, turn: float, longest: float
) -> tuple[Arrow, bool]:
    """Return the arrow that starts at `turn` (rad) from the straight path, and whether it is whole.

    It ends before the goal's rim, and well before any of the `others`, which it must not seem to
    lead to.
    """
    first = RIM_RADIUS + GAP
    path, outward = _walk(skin, start, goal, turn, first + longest)
    along = np.arange(first, min(first + longest, STEP * (len(path) - 1)), 0.5)
    places = _at(path, along)[:, None]
    is_foreign = (np.linalg.norm(places - others, axis=2) < RIM_RADIUS + BERTH).any(axis=1)
    is_over = is_foreign | (np.linalg.norm(places[:, 0] - goal, axis=1) < RIM_RADIUS + GAP)
    stop = int(is_over.argmax()) if is_over.any() else len(along) - 1
    end = float(along[stop]) if len(along) else first
    return Arrow(path, outward, first, end), not is_foreign[: stop + 1].any()


def _walk(
    skin: Skin, start: np.ndarray, goal: np.ndarray, turn: float, longest: float
) -> tuple[np.ndarray, np.ndarray]:
    """Walk over the skin, `turn` (rad) off `goal`; return places a step apart, and normals."""
    outward = skin.outward(start)
    place = skin.onto(np.atleast_2d(start), outward)[0]
    path, normals = [place], [outward]
    while STEP * (len(path) - 1) < longest and np.linalg.norm(goal - place) > STEP:
        toward = goal - place
        along = toward - (toward @ outward) * outward
        if np.linalg.norm(along) < 1e-6:
            break  # The goal is straight below: on the other side of the head.
        along = np.cos(turn) * along + np.sin(turn) * np.cross(outward, along)
        ahead = place + STEP * along / np.linalg.norm(along)
        place = skin.onto(ahead[None], outward)[0]
        outward = skin.outward(place)
        path.append(place)
        normals.append(outward)
    return np.array(path), np.array(normals)


def _kept_apart(made: list[Arrow]) -> list[Arrow]:
    """Shorten arrows until none comes near another; as short ones as that may still meet."""
    made = list(made)
    while True:
        close = [
            (i, j)
            for j in range(len(made))
            for i in range(j)
            if _distance(made[i], made[j]) < APART and max(_spare(made[i]), _spare(made[j])) > 0.0
        ]
        if not close:
            return made
        for pair in close:
            longer = max(pair, key=lambda index: _spare(made[index]))
            arrow = made[longer]
            if _spare(arrow) > 0.0:
                end = max(arrow.end - STEP, arrow.start + SHORTEST)
                made[longer] = Arrow(arrow.path, arrow.outward, arrow.start, end)


def _spare(arrow: Arrow) -> float:
    """Return by how much an arrow may be shortened."""
    return arrow.end - arrow.start - SHORTEST


def _distance(first: Arrow, second: Arrow) -> float:
    (a, half_a), (b, half_b) = first.samples(), second.samples()
    if len(a) == 0 or len(b) == 0:
        return np.inf
    apart = np.linalg.norm(a[:, None] - b[None], axis=2)
    return float((apart - half_a[:, None] - half_b[None]).min())


def _at(values: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Interpolate (n, 3) values, a step apart, at lengths of the path (k,)."""
    steps = STEP * np.arange(len(values))
    return np.column_stack([np.interp(along, steps, values[:, axis]) for axis in range(3)])


def _tangents(path: np.ndarray, along: np.ndarray) -> np.ndarray:
    return _at(path, along + STEP / 2.0) - _at(path, along - STEP / 2.0)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def _grid(rows: int, columns: int) -> np.ndarray:
    """Return the triangles (m, 3) of rows that follow each other, each from right to left."""
    corner = (columns * np.arange(rows - 1)[:, None] + np.arange(columns - 1)).reshape(-1)
    left, ahead = corner + 1, corner + columns
    halves = [np.column_stack([corner, ahead, left]), np.column_stack([left, ahead, ahead + 1])]
    return np.concatenate(halves)
