"""The window's icon: a head with its fiducials, and the tool at the next one."""

from __future__ import annotations

import numpy as np

from rastrainer_simulator.desktop.panels.canvas import Box, Canvas
from rastrainer_simulator.desktop.panels.theme import Color, rgba

SIZE = 64
NIGHT, SKIN, ARM = rgba(0x0E1726), rgba(0xD9A88C), rgba(0xF07818)
DISKS: tuple[tuple[int, int, int, Color], ...] = (
    (42, 42, 17, SKIN),
    (34, 31, 4, rgba(0xFFCC0D)),
    (46, 31, 4, rgba(0x199E40)),
    (53, 40, 4, rgba(0x199E40)),
)


def window_icon() -> np.ndarray:
    """Return (SIZE, SIZE, 4) uint8."""
    canvas = Canvas(SIZE, SIZE)
    canvas.box(Box(0, 0, SIZE, SIZE), NIGHT, 12)
    for x, y, radius, color in DISKS:
        canvas.box(Box(x - radius, y - radius, 2 * radius, 2 * radius), color, radius)
    canvas.stroke([(10, 54), (10, 30), (24, 14), (32, 27)], 6, ARM)
    return canvas.pixels()
