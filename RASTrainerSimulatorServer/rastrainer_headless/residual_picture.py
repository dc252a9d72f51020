"""A picture of the registered points on the head, colored by their residual."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations
from pathlib import Path

import numpy as np
import vtk

from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.registration import Registration
from rastrainer.slicer.polydata import meshPolyData
from rastrainer.slicer.scene.error_colors import (
    RESIDUAL_SCALARS,
    arrowTips,
    glyphsPolyData,
    residualRange,
)

WIDTH, HEIGHT = 1800, 1080
_VIEWS = ((0.0, 0.09, 0.45, 0.92), (0.45, 0.09, 0.9, 0.92))
_LEGEND = (0.9, 0.09, 1.0, 0.92)
_CHARACTER_WIDTH, _LABEL_HEIGHT, _LABEL_GAP = 12, 28, 10
_MARGIN = 1.08
_CLEARLY_FACING = 0.25
_PAPER = (1.0, 1.0, 1.0)
_INK = (0.12, 0.14, 0.18)
_SKIN = (0.86, 0.83, 0.8)
# Viridis, read at five places.
_COLORS = (
    (0.267, 0.005, 0.329),
    (0.230, 0.322, 0.546),
    (0.128, 0.567, 0.551),
    (0.369, 0.789, 0.383),
    (0.993, 0.906, 0.144),
)


def writeResidualPicture(
    path: Path, head: HeadMesh, registration: Registration, title: str, caption: Sequence[str]
) -> None:
    """Render the head from two sides with all points on it; write a PNG, whole or not."""
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(8)
    window.SetSize(WIDTH, HEIGHT)
    window.SetNumberOfLayers(2)
    page = vtk.vtkRenderer()
    page.SetViewport(0.0, 0.0, 1.0, 1.0)
    page.SetBackground(*_PAPER)
    page.AddViewProp(_text(title, 34, (0.5, 0.955), isBold=True))
    page.AddViewProp(_text("\n".join(caption), 24, (0.5, 0.045)))
    window.AddRenderer(page)
    low, high = residualRange(registration)
    colors = vtk.vtkColorTransferFunction()
    for share, color in zip(np.linspace(0.0, 1.0, len(_COLORS)), _COLORS, strict=True):
        colors.AddRGBPoint(low + share * (high - low), *color)
    surface = meshPolyData(head)
    center = 0.5 * (head.vertices.min(axis=0) + head.vertices.max(axis=0))
    away = registration.fixed_mm - center
    outward = away / np.linalg.norm(away, axis=1, keepdims=True)
    directions = chooseTwoViews(outward)
    facing = directions @ outward.T
    shown = np.vstack([head.vertices, arrowTips(registration)])
    for number, viewport in enumerate(_VIEWS):
        view = vtk.vtkRenderer()
        view.SetViewport(*viewport)
        view.SetBackground(*_PAPER)
        skin = _actor(surface)
        skin.GetProperty().SetColor(*_SKIN)
        skin.GetProperty().SetSpecular(0.1)
        view.AddActor(skin)
        screen = _look(view, shown, center, directions[number])
        window.AddRenderer(view)
        isLabeled = facing[number] == facing.max(axis=0)
        rows = np.flatnonzero((facing[number] > _CLEARLY_FACING) | isLabeled)
        glyphs = _glyphView(view, registration, rows, colors)
        _addLabels(glyphs, screen, registration, np.flatnonzero(isLabeled))
        window.AddRenderer(glyphs)
    window.AddRenderer(_legend(colors))
    window.Render()
    image = vtk.vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    writer = vtk.vtkPNGWriter()
    writer.SetInputConnection(image.GetOutputPort())
    partial = path.with_suffix(".partial")
    writer.SetFileName(str(partial))
    writer.Write()
    partial.replace(path)
    window.Finalize()


def _text(
    words: str, size: int, place: tuple[float, float], isBold: bool = False
) -> vtk.vtkTextActor:
    actor = vtk.vtkTextActor()
    actor.SetInput(words)
    style = actor.GetTextProperty()
    style.SetFontSize(size)
    style.SetColor(*_INK)
    style.SetBold(isBold)
    style.SetLineSpacing(1.25)
    style.SetJustificationToCentered()
    style.SetVerticalJustificationToCentered()
    actor.GetPositionCoordinate().SetCoordinateSystemToNormalizedViewport()
    actor.SetPosition(*place)
    return actor


def _glyphView(
    headView: vtk.vtkRenderer,
    registration: Registration,
    rows: np.ndarray,
    colors: vtk.vtkColorTransferFunction,
) -> vtk.vtkRenderer:
    """Return a layer over the head, so that arrows that point inward are seen as well."""
    layer = vtk.vtkRenderer()
    layer.SetLayer(1)
    layer.SetViewport(headView.GetViewport())
    layer.SetActiveCamera(headView.GetActiveCamera())
    glyphs = _actor(glyphsPolyData(registration, rows))
    mapper = glyphs.GetMapper()
    mapper.ScalarVisibilityOn()
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(RESIDUAL_SCALARS)
    mapper.SetLookupTable(colors)
    mapper.UseLookupTableScalarRangeOn()
    glyphs.GetProperty().SetAmbient(0.35)
    layer.AddActor(glyphs)
    return layer


def _actor(data: vtk.vtkPolyData) -> vtk.vtkActor:
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    return actor


def _addLabels(
    view: vtk.vtkRenderer, screen: ViewPlane, registration: Registration, rows: np.ndarray
) -> None:
    """Write number and residual beside the points that this view shows best."""
    texts = [f"{registration.labels[row]}: {registration.residuals_mm[row]:.1f}" for row in rows]
    sizes = np.array([(_CHARACTER_WIDTH * len(text), _LABEL_HEIGHT) for text in texts])
    starts, tips = registration.fixed_mm, arrowTips(registration)
    along = np.linspace(0.0, 1.0, 9)[:, None, None]
    arrows = screen.project((starts + along * (tips - starts)).reshape(-1, 3))
    sides = placeLabels(screen.project(starts[rows]), sizes, arrows, _LABEL_GAP)
    for text, row, (right, up) in zip(texts, rows, sides, strict=True):
        label = vtk.vtkBillboardTextActor3D()
        label.SetInput(text)
        label.SetPosition(starts[row])
        label.SetDisplayOffset(_LABEL_GAP * right, _LABEL_GAP * up)
        style = label.GetTextProperty()
        # VTK's numbers: 0 left or bottom, 1 centered, 2 right or top.
        style.SetJustification(1 - right)
        style.SetVerticalJustification(1 - up)
        style.SetFontSize(22)
        style.SetBold(True)
        style.SetColor(*_INK)
        style.SetBackgroundColor(*_PAPER)
        style.SetBackgroundOpacity(0.65)
        view.AddActor(label)


def _look(
    view: vtk.vtkRenderer, shown: np.ndarray, center: np.ndarray, direction: np.ndarray
) -> ViewPlane:
    """Fill the view with the points `shown`, (n, 3) float, as they are seen from a direction."""
    left, bottom, right, top = view.GetViewport()
    width, height = (right - left) * WIDTH, (top - bottom) * HEIGHT
    rightward = np.cross([0.0, 0.0, 1.0], direction)
    rightward /= np.linalg.norm(rightward)
    axes = np.array([rightward, np.cross(direction, rightward)])
    across = (shown - center) @ axes.T
    low, high = across.min(axis=0), across.max(axis=0)
    pixelsPerMm = float(min(np.array([width, height]) / _MARGIN / (high - low)))
    focus = center + 0.5 * (low + high) @ axes
    camera = view.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(focus)
    camera.SetPosition(focus + 800.0 * direction)
    camera.SetViewUp(0.0, 0.0, 1.0)
    camera.SetParallelScale(0.5 * height / pixelsPerMm)
    camera.SetClippingRange(1.0, 1600.0)
    return ViewPlane(axes, focus, pixelsPerMm)


def _legend(colors: vtk.vtkColorTransferFunction) -> vtk.vtkRenderer:
    legend = vtk.vtkRenderer()
    legend.SetViewport(*_LEGEND)
    legend.SetBackground(*_PAPER)
    bar = vtk.vtkScalarBarActor()
    bar.SetLookupTable(colors)
    bar.SetTitle("Residual (mm)\n")
    low, high = colors.GetRange()
    wholeMillimeters = round(high - low)
    bar.SetNumberOfLabels(wholeMillimeters + 1 if wholeMillimeters <= 8 else 5)
    bar.SetLabelFormat("%.1f")
    bar.UnconstrainedFontSizeOn()
    for style in (bar.GetTitleTextProperty(), bar.GetLabelTextProperty()):
        style.SetColor(*_INK)
        style.SetFontSize(22)
        style.ShadowOff()
        style.ItalicOff()
    bar.GetPositionCoordinate().SetValue(0.05, 0.15)
    bar.SetWidth(0.75)
    bar.SetHeight(0.7)
    legend.AddViewProp(bar)
    return legend


_AZIMUTHS = np.radians(np.arange(0.0, 360.0, 15.0))
_ELEVATIONS = np.radians([0.0, 25.0, 50.0])


def chooseTwoViews(outward: np.ndarray) -> np.ndarray:
    """Return (2, 3) unit vectors, from the head toward two cameras.

    Of all pairs in a grid, the one in which the point that is seen worst is seen best; among
    equals, the one that shows the points, which face along `outward` (n, 3), best on the whole.
    """
    grid = np.array(
        [
            (np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e))
            for e in _ELEVATIONS
            for a in _AZIMUTHS
        ]
    )
    facing = grid @ outward.T

    def worth(pair: Iterable[int]) -> tuple[float, float]:
        seen = facing[list(pair)].max(axis=0)
        return round(float(seen.min()), 2), float(seen.sum())

    return grid[list(max(combinations(range(len(grid)), 2), key=worth))]


@dataclass(frozen=True)
class ViewPlane:
    """How a view maps RAS mm to pixels, counted from its middle.

    Attributes:
        axes: (2, 3) float, unit vectors to the right and up.
        focus: (3,) float, what is in the middle.
        pixelsPerMm: the scale.
    """

    axes: np.ndarray
    focus: np.ndarray
    pixelsPerMm: float

    def project(self, points: np.ndarray) -> np.ndarray:
        """Return (n, 2) pixels of (n, 3) points."""
        return self.pixelsPerMm * (points - self.focus) @ self.axes.T


Side = tuple[int, int]

SIDES: tuple[Side, ...] = ((1, 1), (1, -1), (-1, 1), (-1, -1), (1, 0), (-1, 0), (0, 1), (0, -1))
"""Upper right is preferred; each number is −1, 0 or 1 along right and up."""

_COST_OF_OVERLAP = 10.0


def placeLabels(
    anchors: np.ndarray, sizes: np.ndarray, obstacles: np.ndarray, gap: float
) -> Sequence[Side]:
    """Return on which side of its anchor (n, 2) each label of a size (n, 2) goes, in pixels.

    The labels are placed one after the other, each where it covers the least of others and of the
    obstacles (m, 2).
    """
    placed: list[np.ndarray] = []
    sides: list[Side] = []
    directions = np.array(SIDES)
    for anchor, size in zip(anchors, sizes, strict=True):
        # The lower left and the upper right corner on each side.
        lower = anchor + gap * directions + 0.5 * (directions - 1) * size
        boxes = np.stack([lower, lower + size], axis=1)
        costs = [_cost(box, placed, obstacles) for box in boxes]
        best = int(np.argmin(costs))
        placed.append(boxes[best])
        sides.append(SIDES[best])
    return sides


def _cost(box: np.ndarray, placed: Sequence[np.ndarray], obstacles: np.ndarray) -> float:
    lower, upper = box
    overlaps = [
        np.prod(np.clip(np.minimum(upper, other[1]) - np.maximum(lower, other[0]), 0.0, None))
        for other in placed
    ]
    covered = np.all((obstacles > lower) & (obstacles < upper), axis=1).sum()
    return _COST_OF_OVERLAP * float(sum(overlaps)) / float(np.prod(upper - lower)) + float(covered)
