"""A picture of the registered points on the head, colored by their residual."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import vtk
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

WIDTH, HEIGHT = 1800, 1080
_PIXELS_PER_INCH = 72
"""So that a point of a font is a pixel."""
_VIEW = 810, 896
"""Width and height of the view from one side."""
_BOTTOM = 0.09
_ELEVATION_DEG = 30.0
_AROUND_MM = 8.0
_CLEARLY_FACING = 0.25
_LABEL = np.array([108.0, 30.0])
"""Width and height of a label, pixels."""
_CORNERS = np.array([[1, 1], [-1, 1], [1, -1], [-1, -1]])
"""Places of a label next to its point: to the right or left, above or below."""
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
    points, tips = registration.fixed_mm, arrowTips(registration)
    shown = np.vstack([head.vertices, tips])
    outward = (points - head.middle) / np.linalg.norm(points - head.middle, axis=1, keepdims=True)
    directions = _oppositeDirections(outward)
    facing = directions @ outward.T
    for number, direction in enumerate(directions):
        isLabeled = facing[number] == facing.max(axis=0)
        rows = np.flatnonzero((facing[number] > _CLEARLY_FACING) | isLabeled)
        glyphs = glyphsPolyData(registration, rows)
        residuals = vtk_to_numpy(glyphs.GetPointData().GetArray(RESIDUAL_SCALARS))
        glyphs.GetPointData().SetScalars(vtkArray(colors.to_rgba(residuals, bytes=True)))
        rightward = np.cross([0.0, 0.0, 1.0], direction)
        rightward /= np.linalg.norm(rightward)
        across = np.array([rightward, np.cross(direction, rightward)])
        # All views have the scale that is needed around the middle of the head.
        reach = np.abs((shown - head.middle) @ across.T).max(axis=0) + _AROUND_MM
        half = (reach / _VIEW).max() * np.array(_VIEW)
        pixels = _rendered(surface, glyphs, head.middle, direction, half[1])
        place = (number * _VIEW[0] / WIDTH, _BOTTOM, _VIEW[0] / WIDTH, _VIEW[1] / HEIGHT)
        view = page.add_axes(place)
        view.axis("off")
        view.imshow(pixels, extent=(-half[0], half[0], -half[1], half[1]), aspect="auto")
        balls, ends = (
            (x - head.middle) @ across.T * _VIEW[0] / half[0] / 2 for x in (points, tips)
        )
        labels: list[np.ndarray] = []
        for row in np.flatnonzero(isLabeled):
            others = [*balls[rows[rows != row]], *(balls + ends)[rows] / 2, *ends[rows], *labels]
            middles = balls[row] + _CORNERS * (_LABEL / 2 + 10)
            away = np.abs((middles[:, None] - others) / _LABEL).max(axis=-1).min(axis=1)
            (right, up), middle = _CORNERS[away.argmax()], middles[away.argmax()]
            labels.append(middle)
            view.annotate(
                f"{registration.labels[row]}: {registration.residuals_mm[row]:.1f}",
                across @ (points[row] - head.middle),
                (10 * right, 10 * up),
                textcoords="offset points",
                ha="left" if right > 0 else "right",
                va="bottom" if up > 0 else "top",
                size=20,
                weight="bold",
                color=_INK,
                bbox={"facecolor": "white", "alpha": 0.65, "edgecolor": "none", "pad": 1.0},
            )
    legend = page.colorbar(colors, page.add_axes((0.92, 0.21, 0.025, 0.58)))
    legend.set_label("Residual (mm)", size=22, color=_INK)
    legend.ax.tick_params(labelsize=22, labelcolor=_INK)
    content = io.BytesIO()
    page.savefig(content, format="png")
    write_bytes(path, content.getvalue())


def _oppositeDirections(outward: np.ndarray) -> np.ndarray:
    """Return (2, 3) unit vectors, from the head toward two cameras on opposite sides.

    They see best the point that is seen worst; all face along `outward` (n, 3).
    """
    azimuths = np.radians(np.arange(0.0, 180.0, 15.0))[:, None] + [0.0, np.pi]
    level, up = np.cos(np.radians(_ELEVATION_DEG)), np.sin(np.radians(_ELEVATION_DEG))
    sides = level * np.sin(azimuths), level * np.cos(azimuths), np.full_like(azimuths, up)
    pairs = np.stack(sides, axis=-1)
    return pairs[(pairs @ outward.T).max(axis=1).min(axis=1).argmax()]


def _rendered(
    surface: vtk.vtkPolyData,
    glyphs: vtk.vtkPolyData,
    focus: np.ndarray,
    direction: np.ndarray,
    halfHeightMm: float,
) -> np.ndarray:
    """Return the view from a direction, (height, width, 3) uint8."""
    window = vtk.vtkRenderWindow(
        off_screen_rendering=True, multi_samples=8, size=_VIEW, number_of_layers=2
    )
    camera = vtk.vtkCamera(
        parallel_projection=True,
        focal_point=focus,
        position=focus + 800.0 * direction,
        view_up=(0.0, 0.0, 1.0),
        parallel_scale=halfHeightMm,
        clipping_range=(1.0, 1600.0),
    )
    # The glyphs are a layer over the head, so that arrows that point inward are seen as well.
    for layer, (data, specular, ambient) in enumerate(((surface, 0.1, 0.0), (glyphs, 0.0, 0.35))):
        look = vtk.vtkProperty(color=_SKIN, specular=specular, ambient=ambient)
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(data)
        renderer = vtk.vtkRenderer(layer=layer, background=(1.0,) * 3, active_camera=camera)
        renderer.AddActor(vtk.vtkActor(mapper=mapper, property=look))
        window.AddRenderer(renderer)
    window.Render()
    image = vtk.vtkWindowToImageFilter(input=window, read_front_buffer=False)
    image.Update()
    pixels = vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())
    window.Finalize()
    return pixels.reshape(_VIEW[1], _VIEW[0], 3)[::-1]
