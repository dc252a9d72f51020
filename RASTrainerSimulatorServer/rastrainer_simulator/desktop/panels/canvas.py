"""Pictures over the scene: painted with smooth edges and transparency, read, and shown."""

from __future__ import annotations

import io
from collections.abc import Iterable
from enum import Enum
from itertools import pairwise
from typing import NamedTuple

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
from rastrainer_simulator.desktop.panels.theme import Color


class Box(NamedTuple):
    """A rectangle in pixels, y down: left, top, width, height."""

    left: int
    top: int
    width: int
    height: int

    def inset(self, by: int) -> Box:
        """Return the box made smaller by a margin on each side."""
        return Box(self.left + by, self.top + by, self.width - 2 * by, self.height - 2 * by)

    def contains(self, x: float, y: float) -> bool:
        """Return whether a point is inside."""
        return self.left <= x < self.left + self.width and self.top <= y < self.top + self.height


class Letters(NamedTuple):
    """A set line: (height, width) uint8 coverage, and the height of its baseline from below."""

    coverage: np.ndarray
    descent: int


class Canvas:
    """A picture that begins empty."""

    def __init__(self, width: int, height: int):
        self.width = max(1, width)
        self.height = max(1, height)
        # Color times opacity, and opacity: one plane each, which is fastest to paint on.
        self._painted = np.zeros((4, self.height, self.width), np.float32)

    def box(self, box: Box, color: Color, radius: float = 0.0) -> None:
        """Fill a rectangle with rounded corners."""
        self._cover(box.left, box.top, _rounded(box.width, box.height, radius), color)

    def frame(self, box: Box, color: Color, radius: float, thickness: int) -> None:
        """Draw a line along the inner side of a rectangle with rounded corners."""
        cover = _rounded(box.width, box.height, radius)
        inner = box.inset(thickness)
        if inner.width > 0 and inner.height > 0:
            hole = _rounded(inner.width, inner.height, max(0.0, radius - thickness))
            cover[thickness:-thickness, thickness:-thickness] -= hole
        self._cover(box.left, box.top, cover, color)

    def text(self, letters: Letters, left: int, baseline: int, color: Color) -> None:
        top = baseline + letters.descent - letters.coverage.shape[0] + 1
        self._cover(left, top, letters.coverage.astype(np.float32) / 255.0, color)

    def stroke(self, points: list[tuple[float, float]], thickness: float, color: Color) -> None:
        """Draw a line through points, with round ends."""
        corners = np.array(points)
        reach = thickness / 2.0 + 1.0
        left, top = np.floor(corners.min(axis=0) - reach).astype(int)
        right, bottom = np.ceil(corners.max(axis=0) + reach).astype(int)
        x, y = np.meshgrid(np.arange(left, right) + 0.5, np.arange(top, bottom) + 0.5)
        nearest = np.full(x.shape, np.inf)
        for start, end in pairwise(corners):
            nearest = np.minimum(nearest, _distance(x, y, start, end))
        cover = np.clip(thickness / 2.0 - nearest + 0.5, 0.0, 1.0)
        self._cover(int(left), int(top), cover.astype(np.float32), color)

    def polygon(self, points: list[tuple[float, float]], color: Color) -> None:
        """Fill a convex polygon whose corners go around clockwise as seen (y down)."""
        corners = np.array(points)
        left, top = np.floor(corners.min(axis=0) - 1.0).astype(int)
        right, bottom = np.ceil(corners.max(axis=0) + 1.0).astype(int)
        x, y = np.meshgrid(np.arange(left, right) + 0.5, np.arange(top, bottom) + 0.5)
        inside = np.full(x.shape, np.inf)
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            along = (end - start) / np.linalg.norm(end - start)
            inside = np.minimum(inside, along[0] * (y - start[1]) - along[1] * (x - start[0]))
        cover = np.clip(inside + 0.5, 0.0, 1.0)
        self._cover(int(left), int(top), cover.astype(np.float32), color)

    def picture(self, left: int, top: int, pixels: np.ndarray) -> None:
        """Lay a picture (height, width, 3) uint8 over what is there; it lies within the canvas."""
        height, width = pixels.shape[:2]
        region = self._painted[:, top : top + height, left : left + width]
        region[:3] = pixels.transpose(2, 0, 1) / np.float32(255.0)
        region[3] = 1.0

    def pixels(self) -> np.ndarray:
        """Return (height, width, 4) uint8: color, not multiplied by opacity, and opacity."""
        opacity = self._painted[3]
        share = 255.0 / np.maximum(opacity, 1e-6)
        made = np.empty((self.height, self.width, 4), np.uint8)
        for channel in range(3):
            made[..., channel] = np.minimum(self._painted[channel] * share + 0.5, 255.0)
        made[..., 3] = opacity * 255.0 + 0.5
        return made

    def _cover(self, left: int, top: int, cover: np.ndarray, color: Color) -> None:
        """Lay a color over what is there, as much as `cover` (height, width) says."""
        height, width = cover.shape
        rows = slice(max(0, -top), min(height, self.height - top))
        columns = slice(max(0, -left), min(width, self.width - left))
        if rows.start >= rows.stop or columns.start >= columns.stop:
            return
        cover = cover[rows, columns] * np.float32(color[3])
        bottom, right = top + rows.stop, left + columns.stop
        for plane, value in zip(self._painted, (*color[:3], 1.0), strict=True):
            region = plane[top + rows.start : bottom, left + columns.start : right]
            region += cover * (np.float32(value) - region)


def _rounded(width: int, height: int, radius: float) -> np.ndarray:
    """Return how much of each pixel a rectangle with rounded corners covers."""
    cover = np.ones((height, width), np.float32)
    radius = min(radius, width / 2.0, height / 2.0)
    size = int(np.ceil(radius))
    if size < 1:
        return cover
    away = radius - (np.arange(size) + 0.5)
    corner = np.clip(radius - np.hypot(away[:, None], away[None, :]) + 0.5, 0.0, 1.0)
    for rows, part in ((slice(size), corner), (slice(-size, None), corner[::-1])):
        cover[rows, :size] = np.minimum(cover[rows, :size], part)
        cover[rows, -size:] = np.minimum(cover[rows, -size:], part[:, ::-1])
    return cover


def _distance(x: np.ndarray, y: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    along = end - start
    length = float(along @ along) or 1.0
    share = np.clip(((x - start[0]) * along[0] + (y - start[1]) * along[1]) / length, 0.0, 1.0)
    return np.hypot(x - start[0] - share * along[0], y - start[1] - share * along[1])


class Side(Enum):
    """A side of the picture, counterclockwise."""

    TOP = "top"
    LEFT = "left"
    BOTTOM = "bottom"
    RIGHT = "right"


def plain_picture(color: Color) -> np.ndarray:
    canvas = Canvas(1, 1)
    canvas.box(Box(0, 0, 1, 1), color)
    return canvas.pixels()


def frame_picture(outer: Box, thickness: int, color: Color) -> np.ndarray:
    """Return a frame as large as a box, empty inside."""
    canvas = Canvas(outer.width, outer.height)
    canvas.frame(Box(0, 0, outer.width, outer.height), color, 0.0, thickness)
    return canvas.pixels()


def fringe_picture(thickness: int, color: Color, side: Side) -> np.ndarray:
    """Return a fringe that is full at its side and fades away inward, to be stretched along."""
    fade = np.linspace(1.0, 0.0, thickness) ** 1.5
    # Two pixels wide: VTK takes a picture of one for a row.
    pixels = np.empty((thickness, 2, 4), np.uint8)
    pixels[..., :3] = np.round(255.0 * np.array(color[:3]))
    pixels[..., 3] = np.round(255.0 * color[3] * fade)[:, None]
    return np.rot90(pixels, list(Side).index(side))


class Thumbnail:
    """A picture that can be made in any size; two are equal only if they are identical."""

    def __init__(self, surface: pygame.Surface):
        self._surface = surface

    @classmethod
    def from_png(cls, content: bytes) -> Thumbnail:
        """Return the picture of a PNG file."""
        try:
            surface = pygame.image.load(io.BytesIO(content), "picture.png")
        except pygame.error as error:
            raise InputError(f"A picture of the simulator cannot be read: {error}.") from None
        # Of 24 bits, whatever the file has.
        plain = pygame.Surface(surface.get_size(), depth=24)
        plain.blit(surface, (0, 0))
        return cls(plain)

    def fitted(self, width: int, height: int) -> np.ndarray:
        """Return it scaled to fit, (height, width, 3) uint8, the top row first."""
        across, down = self._surface.get_size()
        factor = min(width / across, height / down)
        size = (max(1, round(factor * across)), max(1, round(factor * down)))
        scaled = pygame.transform.smoothscale(self._surface, size)
        return pygame.surfarray.array3d(scaled).transpose(1, 0, 2)


_CORNERS = ((0, 0), (1, 0), (1, 1), (0, 1))


OPAQUE, CLEAR = 0.999, 0.2
COVERS_PX = 16
"""A sprite this near to a pixel covers it; one that has, until it is twice as far away."""


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
        self._actor.GetProperty().SetOpacity(OPAQUE)
        self._actor.SetLayerNumber(order)
        self._actor.VisibilityOff()
        self.size = (0, 0)
        self._box = Box(0, 0, 0, 0)
        self._is_clear = False
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
        self._box = Box(round(left), round(bottom), round(width), round(height))
        self._actor.VisibilityOn()

    def show_through(self, places: Iterable[tuple[int, int]]) -> None:
        """Be translucent where it would cover any of some pixels, from the lower left corner."""
        margin = COVERS_PX * (2 if self._is_clear else 1)
        around = self._box.inset(-margin)
        self._is_clear = any(around.contains(*place) for place in places)
        self._actor.GetProperty().SetOpacity(CLEAR if self._is_clear else OPAQUE)

    def hide(self) -> None:
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
