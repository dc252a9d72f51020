"""A picture of the registered points on the head, colored by their residual."""

from __future__ import annotations

import io
from collections.abc import Iterable, Sequence
from itertools import combinations
from pathlib import Path

import numpy as np
import vtk
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from vtk.util.numpy_support import vtk_to_numpy

from rastrainer.files.writing import write_bytes
from rastrainer.head.mesh import HeadMesh
from rastrainer.registration.registration import Registration
from rastrainer.slicer.polydata import meshPolyData, vtkArray
from rastrainer.slicer.scene.error_colors import (
    RESIDUAL_SCALARS,
    arrowTips,
    glyphsPolyData,
    residualRange,
)
from rastrainer.slicer.scene.nodes import setValues

WIDTH, HEIGHT = 1800, 1080
_PIXELS_PER_INCH = 72
"""So that a point of a font is a pixel."""
_VIEW = 810, 896
"""Width and height of the view from one side."""
_BOTTOM = 0.09
_LABEL_SIZE, _LABEL_GAP = (100, 28), 10
_SIDES = ((1, 1), (1, -1), (-1, 1), (-1, -1))
"""Sides of a point for its label: right or left, above or below."""
_MARGIN = 1.08
_CLEARLY_FACING = 0.25
_INK = (0.12, 0.14, 0.18)
_SKIN = (0.86, 0.83, 0.8)


def writeResidualPicture(
    path: Path, head: HeadMesh, registration: Registration, title: str, caption: Sequence[str]
) -> None:
    """Render the head from two sides with all points on it; write a PNG, whole or not."""
    size = WIDTH / _PIXELS_PER_INCH, HEIGHT / _PIXELS_PER_INCH
    page = Figure(size, _PIXELS_PER_INCH, facecolor="white")
    page.text(0.5, 0.955, title, size=32, weight="bold", color=_INK, ha="center", va="center")
    page.text(0.5, 0.045, "\n".join(caption), size=21, color=_INK, ha="center", va="center")
    colors = ScalarMappable(Normalize(*residualRange(registration)), "viridis")
    surface = meshPolyData(head)
    center = 0.5 * (head.vertices.min(axis=0) + head.vertices.max(axis=0))
    away = registration.fixed_mm - center
    outward = away / np.linalg.norm(away, axis=1, keepdims=True)
    directions = chooseTwoViews(outward)
    facing = directions @ outward.T
    shown = np.vstack([head.vertices, arrowTips(registration)])
    for number, direction in enumerate(directions):
        isLabeled = facing[number] == facing.max(axis=0)
        rows = np.flatnonzero((facing[number] > _CLEARLY_FACING) | isLabeled)
        rightward = np.cross([0.0, 0.0, 1.0], direction)
        rightward /= np.linalg.norm(rightward)
        across = np.array([rightward, np.cross(direction, rightward)])
        ends = np.array([(shown @ across.T).min(axis=0), (shown @ across.T).max(axis=0)])
        middle = ends.mean(axis=0)
        half = 0.5 * _MARGIN * (np.ptp(ends, axis=0) / _VIEW).max() * np.array(_VIEW)
        focus = middle @ across + (center @ direction) * direction
        glyphs = glyphsPolyData(registration, rows)
        residuals = vtk_to_numpy(glyphs.GetPointData().GetArray(RESIDUAL_SCALARS))
        glyphs.GetPointData().SetScalars(vtkArray(colors.to_rgba(residuals, bytes=True)))
        pixels = _rendered(surface, glyphs, focus, direction, half[1])
        place = (number * _VIEW[0] / WIDTH, _BOTTOM, _VIEW[0] / WIDTH, _VIEW[1] / HEIGHT)
        view = page.add_axes(place)
        view.axis("off")
        low, high = middle - half, middle + half
        view.imshow(pixels, extent=(low[0], high[0], low[1], high[1]), aspect="auto")
        _addLabels(view, registration, np.flatnonzero(isLabeled), across, 2.0 * half / _VIEW)
    legend = page.colorbar(colors, page.add_axes((0.92, 0.21, 0.025, 0.58)))
    legend.set_label("Residual (mm)", size=22, color=_INK)
    legend.ax.tick_params(labelsize=22, labelcolor=_INK)
    content = io.BytesIO()
    page.savefig(content, format="png")
    write_bytes(path, content.getvalue())


def _rendered(
    surface: vtk.vtkPolyData,
    glyphs: vtk.vtkPolyData,
    focus: np.ndarray,
    direction: np.ndarray,
    halfHeightMm: float,
) -> np.ndarray:
    """Return the view from a direction, (height, width, 3) uint8."""
    # A layer over the head, so that arrows that point inward are seen as well.
    window = setValues(
        vtk.vtkRenderWindow(),
        OffScreenRendering=True,
        MultiSamples=8,
        Size=_VIEW,
        NumberOfLayers=2,
    )
    camera = setValues(
        vtk.vtkCamera(),
        ParallelProjection=True,
        FocalPoint=focus,
        Position=focus + 800.0 * direction,
        ViewUp=(0.0, 0.0, 1.0),
        ParallelScale=halfHeightMm,
        ClippingRange=(1.0, 1600.0),
    )
    for layer, (data, specular, ambient) in enumerate(((surface, 0.1, 0.0), (glyphs, 0.0, 0.35))):
        mapper = setValues(vtk.vtkPolyDataMapper(), InputData=data)
        actor = setValues(vtk.vtkActor(), Mapper=mapper)
        setValues(actor.GetProperty(), Color=_SKIN, Specular=specular, Ambient=ambient)
        renderer = setValues(
            vtk.vtkRenderer(), Layer=layer, Background=(1.0, 1.0, 1.0), ActiveCamera=camera
        )
        renderer.AddActor(actor)
        window.AddRenderer(renderer)
    window.Render()
    image = vtk.vtkWindowToImageFilter()
    image.SetInput(window)
    image.ReadFrontBufferOff()
    image.Update()
    pixels = vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())
    window.Finalize()
    return pixels.reshape(_VIEW[1], _VIEW[0], 3)[::-1]


def _addLabels(
    view: Axes, registration: Registration, rows: np.ndarray, across: np.ndarray, mmPerPixel: float
) -> None:
    """Write number and residual of points next to them, on the side that has most room."""
    # In the picture, in sizes of a label.
    starts, tips = registration.fixed_mm, arrowTips(registration)
    taken = np.vstack([starts, 0.5 * (starts + tips), tips]) @ across.T
    taken /= mmPerPixel * np.array(_LABEL_SIZE)
    for row in rows:
        middles = taken[row] + 0.6 * np.array(_SIDES)
        room = np.abs(middles[:, None] - taken).max(axis=2).min(axis=1)
        best = int(np.argmax(room.round(3)))
        taken = np.vstack([taken, middles[best]])
        right, up = _SIDES[best]
        view.annotate(
            f"{registration.labels[row]}: {registration.residuals_mm[row]:.1f}",
            across @ starts[row],
            (_LABEL_GAP * right, _LABEL_GAP * up),
            textcoords="offset points",
            ha="left" if right > 0 else "right",
            va="bottom" if up > 0 else "top",
            size=20,
            weight="bold",
            color=_INK,
            bbox={"facecolor": "white", "alpha": 0.65, "edgecolor": "none", "pad": 1.0},
        )


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
