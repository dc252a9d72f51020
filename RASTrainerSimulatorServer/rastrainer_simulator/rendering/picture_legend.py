"""What is written on a picture: which color is what, and a bar of so many millimeters."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401  (registers the text)
from vtkmodules.vtkRenderingCore import vtkRenderer, vtkTextActor

from rastrainer_simulator.scene.nodes import Material

INK = (28, 36, 51)
MARGIN, ROW, SWATCH = 24, 34, (46, 8)
"""Pixels: to the edges, from row to row, and width and height of a line of the legend."""
TEXT_SIZE, THICK = 22, 6
LONGEST_BAR = 0.25
"""Of a scale, as a share of the picture's height."""

Legend = Sequence[tuple[Material, str]]


def write_legend(renderer: vtkRenderer, rows: Legend) -> None:
    """Write what each color is into the lower left corner of a picture that is to be drawn."""
    for number, (_material, text) in enumerate(reversed(rows)):
        _write(renderer, text, MARGIN + SWATCH[0] + 14, MARGIN + number * ROW)


def paint_legend(pixels: np.ndarray, rows: Legend) -> None:
    """Paint the lines beside the legend's words; `pixels` is (height, width, 3) uint8."""
    for number, (material, _text) in enumerate(reversed(rows)):
        middle = MARGIN + number * ROW + TEXT_SIZE // 2
        color = np.round(255.0 * np.array(material.color))
        _paint(pixels, MARGIN, middle, SWATCH[0], SWATCH[1], color)


def bar_mm(height_mm: float) -> float:
    """Return how long the bar is in a picture of that height: 1, 2 or 5 times a power of ten."""
    longest = LONGEST_BAR * height_mm
    power = 10.0 ** math.floor(math.log10(longest))
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= longest)


def write_scale(renderer: vtkRenderer, height_mm: float, width: int) -> None:
    """Write the bar's length into the lower right corner of a picture of that width, in pixels."""
    text = _write(renderer, f"{bar_mm(height_mm):g} mm", width - MARGIN, MARGIN + THICK + 4)
    text.GetTextProperty().SetJustificationToRight()


def paint_scale(pixels: np.ndarray, height_mm: float) -> None:
    """Paint the bar; `pixels` is (height, width, 3) uint8, its height showing so many mm."""
    height, width, _colors = pixels.shape
    long = _bar_px(height_mm, height)
    _paint(pixels, width - MARGIN - long, MARGIN, long, THICK, np.array(INK))


def _bar_px(height_mm: float, height: int) -> int:
    return round(bar_mm(height_mm) / height_mm * height)


def _write(renderer: vtkRenderer, text: str, left: int, bottom: int) -> vtkTextActor:
    actor = vtkTextActor()
    actor.SetInput(text)
    actor.SetDisplayPosition(left, bottom)
    style = actor.GetTextProperty()
    style.SetFontFamilyToArial()
    style.SetFontSize(TEXT_SIZE)
    style.SetColor(*(value / 255.0 for value in INK))
    renderer.AddViewProp(actor)
    return actor


def _paint(
    pixels: np.ndarray, left: int, middle: int, long: int, thick: int, color: np.ndarray
) -> None:
    """Paint a level bar, its middle so far above the lower edge."""
    row = pixels.shape[0] - middle
    pixels[row - thick // 2 : row - thick // 2 + thick, left : left + long] = color
