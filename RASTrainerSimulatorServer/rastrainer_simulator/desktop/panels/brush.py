"""Set text in lines: its width, line breaks, position, and letters.

VTK's FreeType sets them, in its own font, the same on every system. That has no Chinese characters;
these are set in a font of this computer.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401  (registers the text renderer)
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_FONT_FILE
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkRenderingCore import vtkTextProperty, vtkTextRenderer

from rastrainer_simulator.desktop.panels.canvas import Canvas, Letters
from rastrainer_simulator.desktop.panels.theme import Color, TextStyle
from rastrainer_simulator.ops.system_paths import chinese_font

_BASELINE_SHARE = 0.70

_WIDE = "\u2e80-\u9fff\uf900-\ufaff\uff00-\uffef"
"""Chinese characters and their punctuation, for a class of characters of an expression."""
_BEGINS_NO_LINE = r"\s。，、；：？！）”」》…—%°,.;:?!)"
_ENDS_NO_LINE = r"\s（“「《("
_AT_A_CHARACTER = f"(?<=[{_WIDE}])|(?=[{_WIDE}])"
_BEFORE_THE_LAST = f"[{_WIDE}][{_BEGINS_NO_LINE}]*$"
_BREAK = re.compile(
    f"(?<![{_ENDS_NO_LINE}])(?:{_AT_A_CHARACTER})(?![{_BEGINS_NO_LINE}]|{_BEFORE_THE_LAST})"
)


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
        """Return one line; characters missing from the font stay empty."""
        return set_line(text, max(1, round(style.size * self.scale)), style.is_bold)

    def width(self, text: str, style: TextStyle) -> int:
        return self.line(text, style).coverage.shape[1] if text else 0

    def line_height(self, style: TextStyle) -> int:
        """Return the distance of baselines in pixels."""
        return round(style.line * self.scale)

    def wrap(self, text: str, style: TextStyle, width: float) -> list[str]:
        """Break a text into lines of at most `width` pixels, also within a piece that is longer."""
        lines: list[str] = []
        for paragraph in text.split("\n"):
            line = ""
            for between, piece in _pieces(paragraph):
                longer = f"{line}{between}{piece}".strip(" ")
                if self.width(longer, style) <= width:
                    line = longer
                    continue
                if line:
                    lines.append(line)
                *full, line = self._broken(piece, style, width)
                lines.extend(full)
            lines.append(line)
        return lines

    def fit(self, text: str, style: TextStyle, width: float) -> str:
        """Return a text that is at most `width` pixels wide, shortened at its end if needed."""
        if self.width(text, style) <= width:
            return text
        while text and self.width(f"{text}…", style) > width:
            text = text[:-1]
        return f"{text}…"

    def _broken(self, piece: str, style: TextStyle, width: float) -> list[str]:
        parts = [""]
        for letter in piece:
            if parts[-1] and self.width(parts[-1] + letter, style) > width:
                parts.append("")
            parts[-1] += letter
        return parts


def _pieces(paragraph: str) -> Iterator[tuple[str, str]]:
    """Yield what no line may break, each after what stands between it and the piece before.

    That is a space, or nothing between Chinese characters. No-break spaces do not break, and no
    Chinese character is left alone on the last line.
    """
    for word in filter(None, paragraph.split(" ")):
        between = " "
        for piece in filter(None, _BREAK.split(word)):
            yield between, piece
            between = ""


_DPI = 72
_MEASURE_HEIGHT = "x"
_BOLD_SHARE = 1 / 24
"""How much thicker a bold stroke is, of the size: a font file has one weight."""
_IN_THE_FONT = str.maketrans({"\u202f": "\u00a0"})
"""Replacements for characters missing from the font: the narrow no-break space by the wide one."""
_RUNS = re.compile(f"([{_WIDE}]+)")


@lru_cache(maxsize=2000)
def set_line(text: str, pixels: int, is_bold: bool) -> Letters:
    """Return a line of a size in pixels; characters of no font stay empty."""
    runs = filter(None, _RUNS.split(text.translate(_IN_THE_FONT)))
    return _beside([_set_run(run, pixels, is_bold) for run in runs])


def _set_run(text: str, pixels: int, is_bold: bool) -> Letters:
    """Set characters of one font."""
    if not _RUNS.match(text):
        return Letters(_coverage(text, pixels, is_bold, None), _descent(pixels, is_bold, None))
    font = chinese_font()
    if font is None:
        return Letters(np.zeros((pixels, 0), np.uint8), 0)
    coverage = _coverage(text, pixels, False, font)
    if is_bold:
        coverage = _thickened(coverage, _BOLD_SHARE * pixels)
    return Letters(coverage, _descent(pixels, False, font))


def _thickened(coverage: np.ndarray, by: float) -> np.ndarray:
    """Return letters whose strokes are wider to the right, by a number of pixels."""
    whole, rest = divmod(by, 1.0)
    for share in (*(1.0,) * int(whole), rest):
        beside = (share * coverage[:, :-1]).astype(np.uint8)
        coverage[:, 1:] = np.maximum(coverage[:, 1:], beside)
    return coverage


def _beside(runs: list[Letters]) -> Letters:
    """Return runs one after the other on one baseline."""
    if len(runs) == 1:
        return runs[0]
    descent = max((run.descent for run in runs), default=0)
    ascent = max((run.coverage.shape[0] - run.descent for run in runs), default=0)
    padded = [
        np.pad(
            run.coverage,
            ((ascent - run.coverage.shape[0] + run.descent, descent - run.descent), (0, 0)),
        )
        for run in runs
    ]
    return Letters(np.hstack(padded) if padded else np.zeros((0, 0), np.uint8), descent)


@lru_cache(maxsize=100)
def _descent(pixels: int, is_bold: bool, font: Path | None) -> int:
    """Return how far a line's picture reaches below the baseline, in pixels."""
    coverage = _coverage(_MEASURE_HEIGHT, pixels, is_bold, font)
    return coverage.shape[0] - 1 - int(np.flatnonzero((coverage > 127).any(axis=1))[-1])


def _coverage(text: str, pixels: int, is_bold: bool, font: Path | None) -> np.ndarray:
    style = vtkTextProperty()
    style.SetFontFamilyToArial()
    if font is not None:
        style.SetFontFamily(VTK_FONT_FILE)
        style.SetFontFile(str(font))
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
