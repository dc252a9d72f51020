"""A painted picture on the screen, to the pixel."""

from __future__ import annotations

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkFloatArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkRenderingCore import (
    vtkPolyDataMapper2D,
    vtkRenderer,
    vtkTexture,
    vtkTexturedActor2D,
)

_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))


class Sprite:
    """One picture in a renderer's overlay, invisible until it is shown."""

    def __init__(self, renderer: vtkRenderer, order: int = 0):
        """Of overlapping sprites, the one with the higher `order` is in front."""
        self._renderer = renderer
        self._points = vtkPoints()
        self._points.SetNumberOfPoints(4)
        self._texture = vtkTexture()
        self._texture.SetColorModeToDirectScalars()
        self._texture.InterpolateOff()
        self._texture.RepeatOff()
        self._actor = vtkTexturedActor2D()
        mapper = vtkPolyDataMapper2D()
        mapper.SetInputData(_quad(self._points))
        self._actor.SetMapper(mapper)
        self._actor.SetTexture(self._texture)
        self._actor.GetProperty().SetOpacity(0.999)
        self._actor.SetLayerNumber(order)
        self._actor.VisibilityOff()
        self.size = (0, 0)
        renderer.AddViewProp(self._actor)

    def paint(self, pixels: np.ndarray) -> None:
        """Take a picture, (height, width, 4) uint8, the top row first."""
        height, width = pixels.shape[:2]
        image = vtkImageData()
        image.SetDimensions(width, height, 1)
        values = np.ascontiguousarray(pixels[::-1]).reshape(-1, 4)
        image.GetPointData().SetScalars(numpy_to_vtk(values, deep=True))
        self._texture.SetInputData(image)
        self.size = (width, height)

    def show(self, left: float, bottom: float, width: float = 0, height: float = 0) -> None:
        """Show it, its lower left corner so many pixels from the window's; stretched if told."""
        width, height = width or self.size[0], height or self.size[1]
        for index, (right, up) in enumerate(_CORNERS):
            self._points.SetPoint(index, left + right * width, bottom + up * height, 0.0)
        self._points.Modified()
        self._actor.VisibilityOn()

    def hide(self) -> None:
        """Show it no longer."""
        self._actor.VisibilityOff()


def _quad(points: vtkPoints) -> vtkPolyData:
    cells = vtkCellArray()
    cells.InsertNextCell(4)
    places = vtkFloatArray()
    places.SetNumberOfComponents(2)
    for index, corner in enumerate(_CORNERS):
        cells.InsertCellPoint(index)
        places.InsertNextTuple(corner)
    quad = vtkPolyData()
    quad.SetPoints(points)
    quad.SetPolys(cells)
    quad.GetPointData().SetTCoords(places)
    return quad
