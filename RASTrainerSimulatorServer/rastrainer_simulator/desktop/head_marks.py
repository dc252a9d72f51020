"""What is marked on the head: the errors of touches, and what was traced over the skin."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import zip_longest

import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkTubeFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkBillboardTextActor3D, vtkPolyDataMapper

from rastrainer.procedure.plan import MAX_CHECKPOINTS
from rastrainer.registration.surface_error import nearest_traced_mm
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.presentation.look import (
    ARROW_BALL_M,
    ARROW_RADIUS_M,
    FULL_PAINT_SHARE,
    TRACE_LIFT_M,
    TRACE_MARK_M,
    TRACE_RIM_M,
    TRACE_RING_M,
    TRACE_RING_SIDES,
)
from rastrainer_simulator.presentation.messages import TraceNews
from rastrainer_simulator.presentation.screen import ErrorArrow, Tone
from rastrainer_simulator.rendering.lighting import glow
from rastrainer_simulator.scene.nodes import NEXT, TRACED, Color
from rastrainer_simulator.scene.surfaces import surface

_SHAFT_SIDES = 12
NAME_PX, NAME_ABOVE_PX, NAME_BACKGROUND = 24, 16, 0.85
"""Height of a name's letters, its distance above the ball, and the opacity of what is behind."""


class ErrorArrows:
    """Draws arrows, all of a tone in one actor, and the names of balls.

    Attributes:
        actors: one for each tone, hidden where it has no arrows, and one for each name.
    """

    def __init__(self) -> None:
        self._mappers = {tone: vtkPolyDataMapper() for tone in Tone}
        self._names = [_name_actor() for _ in range(MAX_CHECKPOINTS)]
        self._shown: tuple[ErrorArrow, ...] = ()
        self._of_tones = [_actor(tone, mapper) for tone, mapper in self._mappers.items()]
        self.actors = [*self._of_tones, *self._names]

    def show(self, arrows: tuple[ErrorArrow, ...]) -> bool:
        """Show these in place of the previous ones; return whether they differ."""
        if arrows == self._shown:
            return False
        self._shown = arrows
        for (tone, mapper), actor in zip(self._mappers.items(), self._of_tones, strict=True):
            of_tone = [arrow for arrow in arrows if arrow.tone is tone]
            actor.SetVisibility(bool(of_tone))
            if of_tone:
                mapper.SetInputData(_surface(of_tone))
        named = [arrow for arrow in arrows if arrow.name]
        for written, arrow in zip_longest(self._names, named[: len(self._names)]):
            written.SetVisibility(arrow is not None)
            if arrow is not None:
                written.SetInput(arrow.name)
                written.SetPosition(*arrow.end)
        return True


def _name_actor() -> vtkBillboardTextActor3D:
    """Return a name above a ball, which faces every view."""
    actor = vtkBillboardTextActor3D()
    actor.VisibilityOff()
    actor.SetDisplayOffset(0, NAME_ABOVE_PX)
    style = actor.GetTextProperty()
    style.SetFontFamilyToArial()
    style.SetBold(True)
    style.SetColor(theme.TEXT[:3])
    style.SetFontSize(NAME_PX)
    style.SetJustificationToCentered()
    style.SetBackgroundColor(theme.NIGHT[:3])
    style.SetBackgroundOpacity(NAME_BACKGROUND)
    return actor


def _actor(tone: Tone, mapper: vtkPolyDataMapper) -> vtkActor:
    actor = vtkActor()
    mapper.SetInputData(vtkPolyData())
    actor.SetMapper(mapper)
    actor.VisibilityOff()
    red, green, blue, _opacity = theme.TONES[tone]
    glow(actor.GetProperty(), (red, green, blue))
    return actor


def _surface(arrows: Sequence[ErrorArrow]) -> vtkPolyData:
    points, cells, append = vtkPoints(), vtkCellArray(), vtkAppendPolyData()
    for arrow in arrows:
        if arrow.begin != arrow.end:
            cells.InsertNextCell(2)
            cells.InsertCellPoint(points.InsertNextPoint(arrow.begin))
            cells.InsertCellPoint(points.InsertNextPoint(arrow.end))
        ball = vtkSphereSource()
        ball.SetCenter(arrow.end)
        ball.SetRadius(ARROW_BALL_M)
        append.AddInputConnection(ball.GetOutputPort())
    if cells.GetNumberOfCells() == 0:
        append.Update()
        return append.GetOutput()
    lines = vtkPolyData()
    lines.SetPoints(points)
    lines.SetLines(cells)
    tubes = vtkTubeFilter()
    tubes.SetInputData(lines)
    tubes.SetRadius(ARROW_RADIUS_M)
    tubes.SetNumberOfSides(_SHAFT_SIDES)
    append.AddInputConnection(tubes.GetOutputPort())
    append.Update()
    return append.GetOutput()


@dataclass(frozen=True, eq=False)
class ShownTrace:
    """A trace, in the head's frame, m.

    Attributes:
        points: (n, 3) float.
        kept: how many of them were known before the last news.
        covered: so far around them the skin is painted; 0 where it is not.
        place: position and outward normal of the place to draw next; None without one.
    """

    points: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    kept: int = 0
    covered: float = 0.0
    place: tuple[np.ndarray, np.ndarray] | None = None

    def with_update(self, news: TraceNews) -> ShownTrace:
        """Return the trace after what is new."""
        kept = min(news.known, len(self.points))
        new = np.array(news.points, dtype=float).reshape(-1, 3) / MM_PER_M
        place = None
        if news.next is not None:
            place = np.array(news.next.position_mm) / MM_PER_M, np.array(news.next.normal)
        points = np.concatenate([self.points[:kept], new])
        return ShownTrace(points, kept, news.covered_mm / MM_PER_M, place)


class SkinPaint:
    """The paint around a trace.

    Attributes:
        shares: (v,) float, 0 to 1, how much of the paint covers each vertex; None without any.
    """

    def __init__(self) -> None:
        self.shares: np.ndarray | None = None
        self._points = np.zeros((0, 3))
        self._away = np.zeros(0)

    def cover(self, vertices: np.ndarray, trace: ShownTrace) -> bool:
        """Cover the vertices (v, 3), m, around a trace; return whether the paint has changed."""
        known = min(len(self._points), len(trace.points))
        if len(self._points) > known or not np.array_equal(trace.points[:known], self._points):
            known = 0
        if known == 0:
            self._away = np.full(len(vertices), np.inf)
        had_any, is_new = self.shares is not None, len(trace.points) != len(self._points)
        self._away = nearest_traced_mm(vertices, trace.points[known:], self._away)
        self._points = trace.points
        if not trace.covered or not len(trace.points):
            self.shares = None
            return had_any
        fading = (1.0 - self._away / trace.covered) / (1.0 - FULL_PAINT_SHARE)
        self.shares = np.clip(fading, 0.0, 1.0)
        return is_new or known == 0 or not had_any


_CORNERS = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
_FACES = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
)
"""An octahedron: in a few pixels it cannot be distinguished from a ball."""


class TraceMarks:
    """Draws a trace.

    Attributes:
        actors: of the points, of the ring and of its rim.
    """

    def __init__(self) -> None:
        self._head = vtkMatrix4x4()
        self.actors = [self._actor(color) for color in (TRACED.color, NEXT.color, TRACED.color)]
        self._shown: ShownTrace | None = None
        self._place(np.eye(4))

    def show(self, trace: ShownTrace, head_to_world: np.ndarray) -> bool:
        """Show a trace on a head, (4, 4) float, m; return whether it has changed."""
        self._place(head_to_world)
        if trace is self._shown:
            return False
        self._shown = trace
        points, ring, rim = self.actors
        _fill(points, _marks(trace.points) if len(trace.points) else None)
        for actor, radii in ((ring, TRACE_RING_M), (rim, TRACE_RIM_M)):
            _fill(actor, None if trace.place is None else _ring(*trace.place, radii))
        return True

    def _place(self, head_to_world: np.ndarray) -> None:
        self._head.DeepCopy(head_to_world.ravel().tolist())

    def _actor(self, color: Color) -> vtkActor:
        actor = vtkActor()
        mapper = vtkPolyDataMapper()
        mapper.SetInputData(vtkPolyData())
        actor.SetMapper(mapper)
        actor.SetUserMatrix(self._head)
        actor.VisibilityOff()
        glow(actor.GetProperty(), color)
        return actor


def _fill(actor: vtkActor, shape: vtkPolyData | None) -> None:
    actor.SetVisibility(shape is not None)
    if shape is not None:
        mapper = actor.GetMapper()
        assert isinstance(mapper, vtkPolyDataMapper)
        mapper.SetInputData(shape)


def _marks(points: np.ndarray) -> vtkPolyData:
    vertices = (points[:, None] + TRACE_MARK_M * _CORNERS).reshape(-1, 3)
    triangles = _FACES + len(_CORNERS) * np.arange(len(points))[:, None, None]
    return surface(vertices, triangles.reshape(-1, 3))


def _ring(position: np.ndarray, normal: np.ndarray, radii: tuple[float, float]) -> vtkPolyData:
    across = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    across /= np.linalg.norm(across)
    angles = np.linspace(0.0, 2.0 * np.pi, TRACE_RING_SIDES, endpoint=False)[:, None]
    around = np.cos(angles) * across + np.sin(angles) * np.cross(normal, across)
    middle = position + TRACE_LIFT_M * normal
    vertices = np.concatenate([middle + radius * around for radius in radii])
    here = np.arange(TRACE_RING_SIDES)
    beside = (here + 1) % TRACE_RING_SIDES
    inner = np.stack([here, here + TRACE_RING_SIDES, beside + TRACE_RING_SIDES], axis=1)
    outer = np.stack([here, beside + TRACE_RING_SIDES, beside], axis=1)
    return surface(vertices, np.concatenate([inner, outer]))
