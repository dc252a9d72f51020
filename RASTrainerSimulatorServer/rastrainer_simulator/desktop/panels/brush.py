"""What all panels have in common: a scale, its typesetter, and lines of text on a canvas."""

from __future__ import annotations

from rastrainer_simulator.desktop.canvas import Canvas
from rastrainer_simulator.desktop.theme import Color, Type
from rastrainer_simulator.desktop.typesetter import Typesetter

_BASELINE_SHARE = 0.70


class Brush(Typesetter):
    """Sets text and turns units into pixels, at one scale."""

    def px(self, units: float) -> int:
        """Return a length in pixels; what is not nothing stays at least one."""
        return max(1, round(units * self.scale)) if units > 0 else 0

    def write(
        self, canvas: Canvas, text: str, style: Type, color: Color, left: int, top: int
    ) -> int:
        """Write a line whose row begins at `top`; return the width of its letters in pixels."""
        if not text:
            return 0
        letters = self.line(text, style)
        baseline = top + round(_BASELINE_SHARE * self.line_height(style))
        canvas.text(letters, left, baseline, color)
        return letters.coverage.shape[1]
