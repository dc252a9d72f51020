"""Painted pictures on the screen, to the pixel: sprites, pictures of one color, thumbnails."""

from __future__ import annotations

import io
from enum import Enum

import numpy as np
import pygame
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkFloatArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkRenderingCore import (
    vtkPolyDataMapper2D,
    vtkRenderer,
    vtkTexture,
    vtkTexturedActor2D,
)

from rastrainer.errors import InputError
from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.desktop.panels.theme import Color

_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))


class Sprite:
    """One picture in a renderer's overlay, invisible until it is shown."""

    def __init__(self, renderer: vtkRenderer, order: int):
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
        """Show it, its lower left corner so many pixels from the window's, or stretched."""
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


class Side(Enum):
    """A side of the picture, counterclockwise."""

    TOP = "top"
    LEFT = "left"
    BOTTOM = "bottom"
    RIGHT = "right"


def plain(color: Color) -> np.ndarray:
    """Return one pixel, to be stretched."""
    canvas = Canvas(1, 1)
    canvas.box(Box(0, 0, 1, 1), color)
    return canvas.pixels()


def frame(outer: Box, thickness: int, color: Color) -> np.ndarray:
    """Return a frame as large as a box, empty inside."""
    canvas = Canvas(outer.width, outer.height)
    canvas.frame(Box(0, 0, outer.width, outer.height), color, 0.0, thickness)
    return canvas.pixels()


def glow(thickness: int, color: Color, side: Side) -> np.ndarray:
    """Return a fringe that is full at its side and fades away inward, to be stretched along."""
    fade = np.linspace(1.0, 0.0, thickness) ** 1.5
    # Two pixels wide: VTK takes a picture of one for a row.
    pixels = np.empty((thickness, 2, 4), np.uint8)
    pixels[..., :3] = np.round(255.0 * np.array(color[:3]))
    pixels[..., 3] = np.round(255.0 * color[3] * fade)[:, None]
    return np.rot90(pixels, list(Side).index(side))


class Thumbnail:
    """A picture that can be had in any size; two are the same only if they are one."""

    def __init__(self, surface: pygame.Surface):
        self._surface = surface

    @classmethod
    def from_png(cls, content: bytes) -> Thumbnail:
        """Return the picture of a PNG file.

        Raises:
            InputError: it is none.
        """
        try:
            surface = pygame.image.load(io.BytesIO(content), "picture.png")
        except pygame.error as error:
            raise InputError(f"A picture of the simulator cannot be read: {error}.") from None
        # Of 24 bits, whatever the file has.
        plain = pygame.Surface(surface.get_size(), depth=24)
        plain.blit(surface, (0, 0))
        return cls(plain)

    def fitted(self, width: int, height: int) -> np.ndarray:
        """Return it as large as fits, (height, width, 3) uint8, the top row first."""
        across, down = self._surface.get_size()
        factor = min(width / across, height / down)
        size = (max(1, round(factor * across)), max(1, round(factor * down)))
        scaled = pygame.transform.smoothscale(self._surface, size)
        return pygame.surfarray.array3d(scaled).transpose(1, 0, 2)
