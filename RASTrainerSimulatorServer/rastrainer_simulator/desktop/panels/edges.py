"""Pictures of one color: the scrim under a menu, the inset's frame, the glow of a contact."""

from __future__ import annotations

import numpy as np

from rastrainer_simulator.desktop.canvas import Box, Canvas
from rastrainer_simulator.desktop.theme import Color


def plain(color: Color) -> np.ndarray:
    """Return one pixel, to be stretched."""
    canvas = Canvas(1, 1)
    canvas.box(Box(0, 0, 1, 1), color)
    return canvas.pixels()


def frame(width: int, height: int, thickness: int, color: Color) -> np.ndarray:
    """Return a frame that is empty inside."""
    canvas = Canvas(width, height)
    canvas.frame(Box(0, 0, width, height), color, 0.0, thickness)
    return canvas.pixels()


def glow(thickness: int, color: Color) -> np.ndarray:
    """Return a column that is full above and fades away below, to be stretched."""
    fade = np.linspace(1.0, 0.0, thickness) ** 1.5
    # Two pixels wide: VTK takes a picture of one for a row.
    pixels = np.empty((thickness, 2, 4), np.uint8)
    pixels[..., :3] = np.round(255.0 * np.array(color[:3]))
    pixels[..., 3] = np.round(255.0 * color[3] * fade)[:, None]
    return pixels
