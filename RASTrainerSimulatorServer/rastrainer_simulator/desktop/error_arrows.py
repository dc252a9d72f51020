"""The errors of the touches as arrows on the head."""

from __future__ import annotations

from collections.abc import Sequence

from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkTubeFilter
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper

from rastrainer_simulator.desktop.panels import theme
from rastrainer_simulator.desktop.shown_scene import glow
from rastrainer_simulator.net.views.screen import ErrorArrow, Tone

RADIUS_M, BALL_M = 0.001, 0.0022
"""Of an arrow's shaft, and of the ball at its end."""
_SIDES = 12


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
    tubes.SetNumberOfSides(_SIDES)
    append.AddInputConnection(tubes.GetOutputPort())
    append.Update()
    return append.GetOutput()
