"""The trainee's guides on the head's skin: dots, rims, numbers and arrows that follow its curve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import mutable, vtkIdList
from vtkmodules.vtkCommonDataModel import vtkPolyData, vtkStaticCellLocator, vtkStaticPointLocator
from vtkmodules.vtkFiltersCore import vtkTriangleFilter
from vtkmodules.vtkFiltersModeling import vtkAdaptiveSubdivisionFilter
from vtkmodules.vtkFiltersSources import vtkDiskSource
from vtkmodules.vtkRenderingFreeType import vtkVectorText

from rastrainer.head.mesh import HeadMesh
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.scene.nodes import ARROW, MARK_RIM, NUMBER, WAITING, Material, Surface
from rastrainer_simulator.scene.surfaces import surface, triangles_of

REACH = 25.0
PATCH_RADIUS = 10.0


class Skin:
    """A head's surface; points and lengths in mm, RAS."""

    def __init__(self, head: HeadMesh) -> None:
        self._normals = head.vertex_normals
        shape = surface(head.vertices, head.triangles)
        self._cells, self._points = vtkStaticCellLocator(), vtkStaticPointLocator()
        for locator in (self._cells, self._points):
            locator.SetDataSet(shape)
            locator.BuildLocator()

    def outward(self, point: np.ndarray) -> np.ndarray:
        """Return the unit normal (3,) of the skin around a point, its wrinkles smoothed away."""
        near = vtkIdList()
        self._points.FindPointsWithinRadius(PATCH_RADIUS, point.tolist(), near)
        around = [near.GetId(index) for index in range(near.GetNumberOfIds())]
        normal = self._normals[around].sum(axis=0) if around else np.asarray(point, dtype=float)
        return normal / np.linalg.norm(normal)

    def frame(self, point: np.ndarray) -> np.ndarray:
        """Return (3, 3) float: right, up and outward at a point on the skin, as rows.

        Up is the patient's superior direction along the skin; at the crown, posterior.
        """
        outward = self.outward(point)
        up = np.array([0.0, 0.0, 1.0]) if abs(outward[2]) < 0.9 else np.array([0.0, -1.0, 0.0])
        up = up - (up @ outward) * outward
        up /= np.linalg.norm(up)
        return np.array([np.cross(up, outward), up, outward])

    def onto(self, points: np.ndarray, outward: np.ndarray) -> np.ndarray:
        """Return where lines through `points` (n, 3) along `outward` (3,) enter the skin, (n, 3).

        A point whose line misses the skin is not moved.
        """
        placed = points.tolist()
        hit, along, place = [0.0] * 3, mutable(0.0), [0.0] * 3
        part, cell = mutable(0), mutable(0)
        starts, ends = (points + REACH * outward).tolist(), (points - REACH * outward).tolist()
        for row, (start, end) in enumerate(zip(starts, ends, strict=True)):
            # VTK's stubs do not know `mutable`, by which Python gets numbers back.
            if self._cells.IntersectWithLine(  # type: ignore[call-overload]
                start, end, 1e-6, along, hit, place, part, cell
            ):
                placed[row] = tuple(hit)
        return np.array(placed)

    def lay(self, flat: np.ndarray, point: np.ndarray) -> np.ndarray:
        """Project flat points (n, 2) float around a point of the skin; return (n, 3) float."""
        frame = self.frame(point)
        return self.onto(point + flat @ frame[:2], frame[2])


DOT_RADIUS = 4.0
RIM_RADIUS = 5.2
"""Radii of a fiducial's colored disk, and of the pale ring that reaches a little under it."""
NUMBER_HEIGHT = 11.0
LONGEST_EDGE = 1.5

Flat = tuple[np.ndarray, np.ndarray]
"""(n, 2) float points and (m, 3) int triangles."""


def number(label: str) -> Flat:
    """Return a number, its middle at the origin, in pieces small enough to bend."""
    text = vtkVectorText()
    text.SetText(label)
    points, triangles = _flat(text)
    low, high = points.min(axis=0), points.max(axis=0)
    points = (points - (low + high) / 2.0) * NUMBER_HEIGHT / (high[1] - low[1])
    pieces = vtkAdaptiveSubdivisionFilter()
    upright = np.column_stack([points, np.zeros(len(points))])
    pieces.SetInputData(surface(upright, triangles))
    pieces.SetMaximumEdgeLength(LONGEST_EDGE)
    pieces.Update()
    return _counterclockwise(pieces.GetOutput())


def disk(inner: float, outer: float) -> Flat:
    source = vtkDiskSource()
    source.SetInnerRadius(inner)
    source.SetOuterRadius(outer)
    source.SetRadialResolution(3)
    source.SetCircumferentialResolution(32)
    return _flat(source)


def _flat(source: vtkDiskSource | vtkVectorText) -> Flat:
    triangles = vtkTriangleFilter()
    triangles.SetInputConnection(source.GetOutputPort())
    triangles.Update()
    return _counterclockwise(triangles.GetOutput())


def _counterclockwise(made: vtkPolyData) -> Flat:
    """Return VTK's flat shape with all triangles turned to the viewer: text has some of each."""
    points = vtk_to_numpy(made.GetPoints().GetData())[:, :2].astype(float)
    triangles = triangles_of(made)
    (ax, ay), (bx, by) = ((points[triangles[:, i]] - points[triangles[:, 0]]).T for i in (1, 2))
    is_turned_away = ax * by - ay * bx < 0.0
    triangles[is_turned_away] = triangles[is_turned_away][:, ::-1]
    return points, triangles


STEP = 2.0
"""Length of a step, after which the ribbon is projected onto the skin again, mm."""
GAP = 1.3
LENGTHS = (60.0, 26.0, 16.0, 10.0)
"""Greatest length of arrows; shorter where numbers would otherwise find no room.

The first one leads all the way to most next fiducials that are seen with this one.
"""
SHORTEST = 6.0
SHAFT_WIDTH = 2.0
HEAD_WIDTH, HEAD_LENGTH = 5.4, 5.5
APART = 4.0
BERTH = 4.0
"""Margin by which an arrow passes the rim of a fiducial that it does not lead to."""
TURNS = tuple(np.radians((0.0, 12.0, -12.0, 24.0, -24.0, 36.0, -36.0)))
_ACROSS = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])


@dataclass(frozen=True)
class Arrow:
    """The middle line of an arrow; mm, RAS.

    The `path` (n, 3) is on the skin, from the fiducial on, a step apart, with the skin's normals
    `outward`. The arrow starts and ends at lengths of it, the same if there is no room for it.
    """

    path: np.ndarray
    outward: np.ndarray
    start: float
    end: float

    @property
    def length(self) -> float:
        return self.end - self.start

    def half_width(self, along: np.ndarray) -> np.ndarray:
        """Return half the arrow's width at lengths of the path (k,)."""
        left = self.end - along
        head = HEAD_WIDTH / 2.0 * np.clip(left / HEAD_LENGTH, 0.0, 1.0)
        return np.where(left <= HEAD_LENGTH, head, SHAFT_WIDTH / 2.0)

    @cached_property
    def samples(self) -> tuple[np.ndarray, np.ndarray]:
        """Places (k, 3) along the arrow, 1 mm apart, and its half widths (k,) there."""
        if self.end <= self.start:
            return np.empty((0, 3)), np.empty(0)
        along = np.linspace(self.start, self.end, max(2, round(self.end - self.start) + 1))
        return _at(self.path, along), self.half_width(along)


def arrows(skin: Skin, points: np.ndarray, longest: float = LENGTHS[0]) -> list[Arrow]:
    """Return the arrows between consecutive `points` (n, 3) float on the skin, to `longest` mm.

    They keep away from all fiducials and from each other, and are shortened where needed.
    """
    made: list[Arrow] = []
    for index in range(len(points) - 1):
        start, goal = points[index], points[index + 1]
        others = np.delete(points, (index, index + 1), axis=0)
        made.append(_between(skin, start, goal, others, longest, made))
    # Shorten arrows until none comes near another; very short arrows may still meet.
    while True:
        close = [
            (i, j)
            for j in range(len(made))
            for i in range(j)
            if _distance(made[i], made[j]) < APART
            and max(made[i].length, made[j].length) > SHORTEST
        ]
        if not close:
            return made
        for pair in close:
            longer = max(pair, key=lambda index: made[index].length)
            arrow = made[longer]
            if arrow.length > SHORTEST:
                end = max(arrow.end - STEP, arrow.start + SHORTEST)
                made[longer] = Arrow(arrow.path, arrow.outward, arrow.start, end)


def _ribbon(skin: Skin, arrow: Arrow) -> Surface:
    """Return the arrow as a ribbon on the skin: a shaft, and a head that comes to a point."""
    neck = max(arrow.start, arrow.end - HEAD_LENGTH)
    shaft = np.linspace(arrow.start, neck, max(2, round((neck - arrow.start) / STEP) + 1))
    head = np.linspace(neck, arrow.end, 4)
    along = np.concatenate([shaft, head])
    widths = np.concatenate([np.full(len(shaft), SHAFT_WIDTH / 2.0), arrow.half_width(head)])
    middle, outward = _at(arrow.path, along), _unit(_at(arrow.outward, along))
    tangents = _at(arrow.path, along + STEP / 2.0) - _at(arrow.path, along - STEP / 2.0)
    to_left = _unit(np.cross(outward, tangents))
    sides = np.array(_ACROSS)[:, None] * (widths[:, None] * to_left)[:, None]
    rows = [
        skin.onto(row, normal) for row, normal in zip(middle[:, None] + sides, outward, strict=True)
    ]
    # Two triangles between each two points of a row, which go from right to left.
    columns = len(_ACROSS)
    corner = columns * np.arange(len(along) - 1)[:, None] + np.arange(columns - 1)
    right = corner.reshape(-1)
    left, ahead = right + 1, right + columns
    halves = [np.column_stack([right, ahead, left]), np.column_stack([left, ahead, ahead + 1])]
    outward = np.repeat(outward, columns, axis=0)
    return _raised(np.concatenate(rows), outward, np.concatenate(halves), ARROW)


def _between(
    skin: Skin,
    start: np.ndarray,
    goal: np.ndarray,
    others: np.ndarray,
    longest: float,
    made: list[Arrow],
) -> Arrow:
    """Return the arrow from one fiducial toward the next.

    It goes around any of the `others` (k, 3), and if it can, past the arrows that are `made`.
    """
    whole: Arrow | None = None
    best: Arrow | None = None
    for turn in TURNS:
        # It ends before the goal's rim, and well before others, to which it must not seem to lead.
        first = RIM_RADIUS + GAP
        path, outward = _walk(skin, start, goal, turn, first + longest)
        along = np.arange(first, min(first + longest, STEP * (len(path) - 1)), 0.5)
        places = _at(path, along)[:, None]
        is_foreign = (np.linalg.norm(places - others, axis=2) < RIM_RADIUS + BERTH).any(axis=1)
        is_over = is_foreign | (np.linalg.norm(places[:, 0] - goal, axis=1) < RIM_RADIUS + GAP)
        stop = int(is_over.argmax()) if is_over.any() else len(along) - 1
        end = float(along[stop]) if len(along) else first
        arrow, is_whole = Arrow(path, outward, first, end), not is_foreign[: stop + 1].any()
        if is_whole and all(_distance(arrow, each) >= APART for each in made):
            return arrow
        if is_whole and whole is None:
            whole = arrow
        if best is None or arrow.end > best.end + STEP:
            best = arrow
    assert best is not None  # There is at least one turn.
    return best if whole is None else whole


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


def _distance(first: Arrow, second: Arrow) -> float:
    (a, half_a), (b, half_b) = first.samples, second.samples
    if len(a) == 0 or len(b) == 0:
        return np.inf
    apart = np.linalg.norm(a[:, None] - b[None], axis=2)
    return float((apart - half_a[:, None] - half_b[None]).min())


def _at(values: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Interpolate (n, 3) values, a step apart, at lengths of the path (k,)."""
    steps = STEP * np.arange(len(values))
    return np.column_stack([np.interp(along, steps, values[:, axis]) for axis in range(3)])


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


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
    samples = [arrow.samples for arrow in arrows]
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


LIFTS = {ARROW: 0.5, MARK_RIM: 0.5, NUMBER: 0.6, WAITING: 0.8}
"""How far each is above the skin, mm, so that no wrinkle hides it."""


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


def skin_marks(
    head: HeadMesh, points: np.ndarray, labels: Sequence[str]
) -> list[dict[str, Surface]]:
    """Return the marks of fiducials at `points` (n, 3) float, RAS mm, in the order to touch.

    Each has a `rim`, a `fiducial` that fills it, a `number`, and an `arrow` to the next one, if
    there is room for it; RAS, but in m.
    """
    skin = Skin(head)
    placed = place_marks(skin, points, labels)
    marks = [
        {
            "rim": _laid(skin, disk(DOT_RADIUS - 0.4, RIM_RADIUS), point, MARK_RIM),
            "fiducial": _laid(skin, disk(0.0, DOT_RADIUS), point, WAITING),
            "number": _laid(skin, flat, place, NUMBER),
        }
        for point, flat, place in zip(points, placed.numbers, placed.places, strict=True)
    ]
    for mark, arrow in zip(marks, placed.arrows, strict=False):
        if arrow.end > arrow.start:
            mark["arrow"] = _ribbon(skin, arrow)
    return marks


def _laid(skin: Skin, flat: Flat, at: np.ndarray, material: Material) -> Surface:
    """Project a flat shape onto the skin around a point."""
    points, triangles = flat
    outward = np.tile(skin.frame(at)[2], (len(points), 1))
    return _raised(skin.lay(points, at), outward, triangles, material)


def _raised(
    points: np.ndarray, outward: np.ndarray, triangles: np.ndarray, material: Material
) -> Surface:
    return Surface((points + LIFTS[material] * outward) / MM_PER_M, outward, triangles, material)
