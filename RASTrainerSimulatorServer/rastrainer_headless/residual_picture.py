"""A picture of the registered points on the head, colored by their residual."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
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
_LABEL_SIZE, _LABEL_GAP = (100, 28), 10
_SIDES = ((1, 1), (1, -1), (-1, 1), (-1, -1))
"""Sides of a point for its label: right or left, above or below."""
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
    page = _addRenderer(window, (0.0, 0.0, 1.0, 1.0))
    page.AddViewProp(_text(title, 34, (0.5, 0.955), isBold=True))
    page.AddViewProp(_text("\n".join(caption), 24, (0.5, 0.045)))
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
        view = _addRenderer(window, viewport)
        skin = _actor(surface)
        skin.GetProperty().SetColor(*_SKIN)
        skin.GetProperty().SetSpecular(0.1)
        view.AddActor(skin)
        axes = _look(view, shown, center, directions[number])
        isLabeled = facing[number] == facing.max(axis=0)
        rows = np.flatnonzero((facing[number] > _CLEARLY_FACING) | isLabeled)
        # A layer over the head, so that arrows that point inward are seen as well.
        layer = _addRenderer(window, viewport)
        layer.SetLayer(1)
        layer.SetActiveCamera(view.GetActiveCamera())
        layer.AddActor(_glyphs(registration, rows, colors))
        _addLabels(layer, registration, np.flatnonzero(isLabeled), axes)
    _addRenderer(window, _LEGEND).AddViewProp(_legend(colors))
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


def _addRenderer(window: vtk.vtkRenderWindow, viewport: tuple[float, ...]) -> vtk.vtkRenderer:
    renderer = vtk.vtkRenderer()
    renderer.SetViewport(*viewport)
    renderer.SetBackground(*_PAPER)
    window.AddRenderer(renderer)
    return renderer


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


def _glyphs(
    registration: Registration, rows: np.ndarray, colors: vtk.vtkColorTransferFunction
) -> vtk.vtkActor:
    glyphs = _actor(glyphsPolyData(registration, rows))
    mapper = glyphs.GetMapper()
    mapper.ScalarVisibilityOn()
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray(RESIDUAL_SCALARS)
    mapper.SetLookupTable(colors)
    mapper.UseLookupTableScalarRangeOn()
    glyphs.GetProperty().SetAmbient(0.35)
    return glyphs


def _actor(data: vtk.vtkPolyData) -> vtk.vtkActor:
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputData(data)
    mapper.ScalarVisibilityOff()
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    return actor


def _addLabels(
    view: vtk.vtkRenderer, registration: Registration, rows: np.ndarray, axes: np.ndarray
) -> None:
    """Write number and residual of points next to them, on the side that has most room."""
    _left, bottom, _right, top = view.GetViewport()
    pixelsPerMm = 0.5 * (top - bottom) * HEIGHT / view.GetActiveCamera().GetParallelScale()
    # In the picture, in sizes of a label.
    starts, tips = registration.fixed_mm, arrowTips(registration)
    taken = np.vstack([starts, 0.5 * (starts + tips), tips]) @ axes.T
    taken *= pixelsPerMm / np.array(_LABEL_SIZE)
    for row in rows:
        middles = taken[row] + 0.6 * np.array(_SIDES)
        room = np.abs(middles[:, None] - taken).max(axis=2).min(axis=1)
        best = int(np.argmax(room.round(3)))
        taken = np.vstack([taken, middles[best]])
        right, up = _SIDES[best]
        label = vtk.vtkBillboardTextActor3D()
        label.SetInput(f"{registration.labels[row]}: {registration.residuals_mm[row]:.1f}")
        label.SetPosition(registration.fixed_mm[row])
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
) -> np.ndarray:
    """Fill the view with points (n, 3) as seen from a direction; return its axes (2, 3)."""
    rightward = np.cross([0.0, 0.0, 1.0], direction)
    rightward /= np.linalg.norm(rightward)
    axes = np.array([rightward, np.cross(direction, rightward)])
    across = (shown - center) @ axes.T
    low, high = across.min(axis=0), across.max(axis=0)
    left, bottom, right, top = view.GetViewport()
    heightPerWidth = (top - bottom) * HEIGHT / ((right - left) * WIDTH)
    focus = center + 0.5 * (low + high) @ axes
    camera = view.GetActiveCamera()
    camera.ParallelProjectionOn()
    camera.SetFocalPoint(focus)
    camera.SetPosition(focus + 800.0 * direction)
    camera.SetViewUp(0.0, 0.0, 1.0)
    camera.SetParallelScale(0.5 * _MARGIN * max((high - low) * [heightPerWidth, 1.0]))
    camera.SetClippingRange(1.0, 1600.0)
    return axes


def _legend(colors: vtk.vtkColorTransferFunction) -> vtk.vtkScalarBarActor:
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
    return bar


def chooseTwoViews(outward: np.ndarray) -> np.ndarray:
    """Return (2, 3) unit vectors, from the head toward two cameras.

    The pair in a grid that maximizes the visibility of the worst visible point, and then of all
    points, which face along `outward` (n, 3).
    """
    e, a = np.radians(np.meshgrid((0.0, 25.0, 50.0), np.arange(0.0, 360.0, 15.0), indexing="ij"))
    directions = [np.sin(a) * np.cos(e), np.cos(a) * np.cos(e), np.sin(e)]
    grid = np.stack(directions, axis=-1).reshape(-1, 3)
    facing = grid @ outward.T

    def worth(pair: Iterable[int]) -> tuple[float, float]:
        seen = facing[list(pair)].max(axis=0)
        return round(float(seen.min()), 2), float(seen.sum())

    return grid[list(max(combinations(range(len(grid)), 2), key=worth))]
