"""Set text in lines: how wide it is, where it breaks, and where it stands."""

from __future__ import annotations

from dataclasses import dataclass

from rastrainer_simulator.desktop.panels.canvas import Canvas, Letters
from rastrainer_simulator.desktop.panels.letters import set_line
from rastrainer_simulator.desktop.panels.line_breaks import pieces
from rastrainer_simulator.desktop.panels.theme import Color, TextStyle

_BASELINE_SHARE = 0.70


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
        return set_line(text, self._pixels(style), style.is_bold)

    def width(self, text: str, style: TextStyle) -> int:
        """Return the width of a line in pixels."""
        return self.line(text, style).coverage.shape[1] if text else 0

    def line_height(self, style: TextStyle) -> int:
        """Return the distance of baselines in pixels."""
        return round(style.line * self.scale)

    def wrap(self, text: str, style: TextStyle, width: float) -> list[str]:
        """Break a text into lines of at most `width` pixels, also within a piece that is longer."""
        lines: list[str] = []
        for paragraph in text.split("\n"):
            line = ""
            for between, piece in pieces(paragraph):
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
        """Return a text that is at most `width` pixels wide, shortened in the end if need be."""
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

    def _pixels(self, style: TextStyle) -> int:
        return max(1, round(style.size * self.scale))
