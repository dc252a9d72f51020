"""Pictures of one color: the scrim under a menu, the inset's frame, the glow of a contact."""

from __future__ import annotations

from enum import Enum

import numpy as np

from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.desktop.panels.theme import Color


class Side(Enum):
    """A side of the picture, counterclockwise."""

    TOP = "top"
    LEFT = "left"
    BOTTOM = "bottom"
    RIGHT = "right"


def plain(color: Color) -> np.ndarray:
    """Return one pixel, to be stretched."""
    canvas = Canvas(1, 1)
    canvas.box(Box(0, 0, 1, 1), color)
    return canvas.pixels()


def frame(outer: Box, thickness: int, color: Color) -> np.ndarray:
    """Return a frame as large as a box, empty inside."""
    canvas = Canvas(outer.width, outer.height)
    canvas.frame(Box(0, 0, outer.width, outer.height), color, 0.0, thickness)
    return canvas.pixels()


def glow(thickness: int, color: Color, side: Side) -> np.ndarray:
    """Return a fringe that is full at its side and fades away inward, to be stretched along."""
    fade = np.linspace(1.0, 0.0, thickness) ** 1.5
    # Two pixels wide: VTK takes a picture of one for a row.
    pixels = np.empty((thickness, 2, 4), np.uint8)
    pixels[..., :3] = np.round(255.0 * np.array(color[:3]))
    pixels[..., 3] = np.round(255.0 * color[3] * fade)[:, None]
    return np.rot90(pixels, list(Side).index(side))
