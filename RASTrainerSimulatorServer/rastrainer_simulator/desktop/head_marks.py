"""What is marked on the head: the errors of touches, traced points, and the place to draw next."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkCommonMath import vtkMatrix4x4
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkTubeFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.shown_scene import glow
from rastrainer_simulator.desktop.shown_trace import ShownTrace
from rastrainer_simulator.presentation.screen import ErrorArrow, Tone
from rastrainer_simulator.scene.nodes import NEXT, TRACED, Color
from rastrainer_simulator.scene.surfaces import surface

RADIUS_M, BALL_M = 0.001, 0.0022
"""Of an arrow's shaft, and of the ball at its end."""
_SHAFT_SIDES = 12


class ErrorArrows:
    """Draws arrows, all of a tone in one actor.

    Attributes:
        actors: one for each tone, hidden where it has no arrows.
    """

    def __init__(self) -> None:
        self._mappers = {tone: vtkPolyDataMapper() for tone in Tone}
        self._shown: tuple[ErrorArrow, ...] = ()
        self.actors = [_actor(tone, mapper) for tone, mapper in self._mappers.items()]

    def show(self, arrows: tuple[ErrorArrow, ...]) -> bool:
        """Show these in place of others; return whether they are others."""
        if arrows == self._shown:
            return False
        self._shown = arrows
        for (tone, mapper), actor in zip(self._mappers.items(), self.actors, strict=True):
            of_tone = [arrow for arrow in arrows if arrow.tone is tone]
            actor.SetVisibility(bool(of_tone))
            if of_tone:
                mapper.SetInputData(_surface(of_tone))
        return True


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
        ball.SetRadius(BALL_M)
        append.AddInputConnection(ball.GetOutputPort())
    if cells.GetNumberOfCells() == 0:
        append.Update()
        return append.GetOutput()
    lines = vtkPolyData()
    lines.SetPoints(points)
    lines.SetLines(cells)
    tubes = vtkTubeFilter()
    tubes.SetInputData(lines)
    tubes.SetRadius(RADIUS_M)
    tubes.SetNumberOfSides(_SHAFT_SIDES)
    append.AddInputConnection(tubes.GetOutputPort())
    append.Update()
    return append.GetOutput()


MARK_M = 0.0011
RING_M, RIM_M = (0.0052, 0.0075), (0.0075, 0.0088)
"""Inner and outer radius of the ring, and of its dark rim."""
LIFT_M = 0.003
"""So far above the skin the ring lies: it is flat, and the skin is not."""
_RING_SIDES = 40
_CORNERS = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
_FACES = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
)
"""An octahedron: on a few pixels nobody tells it from a ball."""


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
        """Show a trace on a head, (4, 4) float, m; return whether it is another."""
        self._place(head_to_world)
        if trace is self._shown:
            return False
        self._shown = trace
        points, ring, rim = self.actors
        _fill(points, _marks(trace.points) if len(trace.points) else None)
        for actor, radii in ((ring, RING_M), (rim, RIM_M)):
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
    vertices = (points[:, None] + MARK_M * _CORNERS).reshape(-1, 3)
    triangles = _FACES + len(_CORNERS) * np.arange(len(points))[:, None, None]
    return surface(vertices, triangles.reshape(-1, 3))


def _ring(position: np.ndarray, normal: np.ndarray, radii: tuple[float, float]) -> vtkPolyData:
    across = np.cross(normal, np.eye(3)[np.abs(normal).argmin()])
    across /= np.linalg.norm(across)
    angles = np.linspace(0.0, 2.0 * np.pi, _RING_SIDES, endpoint=False)[:, None]
    around = np.cos(angles) * across + np.sin(angles) * np.cross(normal, across)
    middle = position + LIFT_M * normal
    vertices = np.concatenate([middle + radius * around for radius in radii])
    here = np.arange(_RING_SIDES)
    beside = (here + 1) % _RING_SIDES
    inner = np.stack([here, here + _RING_SIDES, beside + _RING_SIDES], axis=1)
    outer = np.stack([here, beside + _RING_SIDES, beside], axis=1)
    return surface(vertices, np.concatenate([inner, outer]))
