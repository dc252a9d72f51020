"""Set text with VTK's own FreeType and fonts: the same letters on every system."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401  (registers the text renderer)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkTextProperty, vtkTextRenderer

from rastrainer_simulator.desktop.panels.canvas import Canvas, Letters
from rastrainer_simulator.desktop.panels.theme import Color, TextStyle

_DPI = 72
_MEASURE_HEIGHT = "x"
_BASELINE_SHARE = 0.70
_IN_THE_FONT = str.maketrans({"\u202f": "\u00a0"})
"""What stands for what the font lacks: for the narrow no-break space, the wide one."""


@dataclass(frozen=True)
class Brush:
    """Sets text and turns units into pixels, at one scale (pixels a unit)."""

    scale: float

    def px(self, units: float) -> int:
        """Return a length in pixels; what is not nothing stays at least one."""
        return max(1, round(units * self.scale)) if units > 0 else 0

    def write(
        self, canvas: Canvas, text: str, style: TextStyle, color: Color, left: int, top: int
    ) -> int:
        """Write a line whose row begins at `top`; return the width of its letters in pixels."""
        if not text:
            return 0
        letters = self.line(text, style)
        baseline = top + round(_BASELINE_SHARE * self.line_height(style))
        canvas.text(letters, left, baseline, color)
        return letters.coverage.shape[1]

    def line(self, text: str, style: TextStyle) -> Letters:
        """Return one line; what the font lacks stays empty."""
        return _set(text, self._pixels(style), style.is_bold)

    def width(self, text: str, style: TextStyle) -> int:
        """Return the width of a line in pixels."""
        return self.line(text, style).coverage.shape[1] if text else 0

    def line_height(self, style: TextStyle) -> int:
        """Return the distance of baselines in pixels."""
        return round(style.line * self.scale)

    def wrap(self, text: str, style: TextStyle, width: float) -> list[str]:
        """Break a text between words into lines of at most `width` pixels, a longer word within."""
        lines: list[str] = []
        for paragraph in text.split("\n"):
            line = ""
            # Not at the spaces of French, which do not break.
            for word in filter(None, paragraph.split(" ")):
                longer = f"{line} {word}".strip()
                if self.width(longer, style) <= width:
                    line = longer
                    continue
                if line:
                    lines.append(line)
                *full, line = self._break_word(word, style, width)
                lines.extend(full)
            lines.append(line)
        return lines

    def fit(self, text: str, style: TextStyle, width: float) -> str:
        """Return a text that is at most `width` pixels wide, shortened in the end if need be."""
        if self.width(text, style) <= width:
            return text
        while text and self.width(f"{text}…", style) > width:
            text = text[:-1]
        return f"{text}…"

    def _break_word(self, word: str, style: TextStyle, width: float) -> list[str]:
        pieces = [""]
        for letter in word:
            if pieces[-1] and self.width(pieces[-1] + letter, style) > width:
                pieces.append("")
            pieces[-1] += letter
        return pieces

    def _pixels(self, style: TextStyle) -> int:
        return max(1, round(style.size * self.scale))


@lru_cache(maxsize=2000)
def _set(text: str, pixels: int, is_bold: bool) -> Letters:
    coverage = _coverage(text.translate(_IN_THE_FONT), pixels, is_bold)
    return Letters(coverage, _descent(pixels, is_bold))


@lru_cache(maxsize=100)
def _descent(pixels: int, is_bold: bool) -> int:
    """Return how far a line's picture reaches below the baseline, in pixels."""
    coverage = _coverage(_MEASURE_HEIGHT, pixels, is_bold)
    return coverage.shape[0] - 1 - int(np.flatnonzero((coverage > 127).any(axis=1))[-1])


def _coverage(text: str, pixels: int, is_bold: bool) -> np.ndarray:
    style = vtkTextProperty()
    style.SetFontFamilyToArial()
    style.SetFontSize(pixels)
    style.SetBold(is_bold)
    style.SetColor(1.0, 1.0, 1.0)
    # Not the tight box: all lines of a size then reach equally far below their baseline.
    style.SetUseTightBoundingBox(False)
    renderer = vtkTextRenderer.GetInstance()
    renderer.SetScaleToPowerOfTwo(False)
    # A dollar sign would begin a formula.
    backend = vtkTextRenderer.FreeType
    image = vtkImageData()
    if not renderer.RenderString(style, text, image, [0, 0], _DPI, backend):
        return np.zeros((pixels, 0), np.uint8)
    width, height, _ = image.GetDimensions()
    scalars = image.GetPointData().GetScalars()
    if scalars is None or width * height == 0:
        return np.zeros((pixels, 0), np.uint8)
    return vtk_to_numpy(scalars).reshape(height, width, -1)[::-1, :, 3].copy()
