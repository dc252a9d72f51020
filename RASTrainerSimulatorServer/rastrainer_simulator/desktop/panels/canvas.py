"""Paint boxes, lines and text into a picture with smooth edges and transparency."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from rastrainer_simulator.desktop.panels.theme import Color


class Box(NamedTuple):
    """A rectangle in pixels, y down: left, top, width, height."""

    left: int
    top: int
    width: int
    height: int

    def inset(self, by: int) -> Box:
        """Return the box that is smaller by so much on each side."""
        return Box(self.left + by, self.top + by, self.width - 2 * by, self.height - 2 * by)

    def contains(self, x: float, y: float) -> bool:
        """Return whether a point is in it."""
        return self.left <= x < self.left + self.width and self.top <= y < self.top + self.height


class Letters(NamedTuple):
    """A set line: (height, width) uint8 coverage, and the height of its baseline from below."""

    coverage: np.ndarray
    descent: int


class Canvas:
    """A picture that begins empty."""

    def __init__(self, width: int, height: int):
        self.width = max(1, width)
        self.height = max(1, height)
        # Color times opacity, and opacity: one plane each, which is fastest to paint on.
        self._painted = np.zeros((4, self.height, self.width), np.float32)

    def box(self, box: Box, color: Color, radius: float = 0.0) -> None:
        """Fill a rectangle with rounded corners."""
        self._cover(box.left, box.top, _rounded(box.width, box.height, radius), color)

    def frame(self, box: Box, color: Color, radius: float, thickness: int) -> None:
        """Draw a line along the inner side of a rectangle with rounded corners."""
        cover = _rounded(box.width, box.height, radius)
        inner = box.inset(thickness)
        if inner.width > 0 and inner.height > 0:
            hole = _rounded(inner.width, inner.height, max(0.0, radius - thickness))
            cover[thickness:-thickness, thickness:-thickness] -= hole
        self._cover(box.left, box.top, cover, color)

    def text(self, letters: Letters, left: int, baseline: int, color: Color) -> None:
        """Write a line from `left` on, its letters standing on `baseline`."""
        top = baseline + letters.descent - letters.coverage.shape[0] + 1
        self._cover(left, top, letters.coverage.astype(np.float32) / 255.0, color)

    def stroke(self, points: list[tuple[float, float]], thickness: float, color: Color) -> None:
        """Draw a line through points, with round ends."""
        corners = np.array(points)
        reach = thickness / 2.0 + 1.0
        left, top = np.floor(corners.min(axis=0) - reach).astype(int)
        right, bottom = np.ceil(corners.max(axis=0) + reach).astype(int)
        x, y = np.meshgrid(np.arange(left, right) + 0.5, np.arange(top, bottom) + 0.5)
        nearest = np.full(x.shape, np.inf)
        for start, end in pairwise(corners):
            nearest = np.minimum(nearest, _distance(x, y, start, end))
        cover = np.clip(thickness / 2.0 - nearest + 0.5, 0.0, 1.0)
        self._cover(int(left), int(top), cover.astype(np.float32), color)

    def polygon(self, points: list[tuple[float, float]], color: Color) -> None:
        """Fill a convex polygon whose corners go around clockwise as seen (y down)."""
        corners = np.array(points)
        left, top = np.floor(corners.min(axis=0) - 1.0).astype(int)
        right, bottom = np.ceil(corners.max(axis=0) + 1.0).astype(int)
        x, y = np.meshgrid(np.arange(left, right) + 0.5, np.arange(top, bottom) + 0.5)
        inside = np.full(x.shape, np.inf)
        for start, end in zip(corners, np.roll(corners, -1, axis=0), strict=True):
            along = (end - start) / np.linalg.norm(end - start)
            inside = np.minimum(inside, along[0] * (y - start[1]) - along[1] * (x - start[0]))
        cover = np.clip(inside + 0.5, 0.0, 1.0)
        self._cover(int(left), int(top), cover.astype(np.float32), color)

    def picture(self, left: int, top: int, pixels: np.ndarray) -> None:
        """Lay a picture (height, width, 3) uint8 over what is there; it lies within the canvas."""
        height, width = pixels.shape[:2]
        region = self._painted[:, top : top + height, left : left + width]
        region[:3] = pixels.transpose(2, 0, 1) / np.float32(255.0)
        region[3] = 1.0

    def pixels(self) -> np.ndarray:
        """Return (height, width, 4) uint8: color, not multiplied by opacity, and opacity."""
        opacity = self._painted[3]
        share = 255.0 / np.maximum(opacity, 1e-6)
        made = np.empty((self.height, self.width, 4), np.uint8)
        for channel in range(3):
            made[..., channel] = np.minimum(self._painted[channel] * share + 0.5, 255.0)
        made[..., 3] = opacity * 255.0 + 0.5
        return made

    def _cover(self, left: int, top: int, cover: np.ndarray, color: Color) -> None:
        """Lay a color over what is there, as much as `cover` (height, width) says."""
        height, width = cover.shape
        rows = slice(max(0, -top), min(height, self.height - top))
        columns = slice(max(0, -left), min(width, self.width - left))
        if rows.start >= rows.stop or columns.start >= columns.stop:
            return
        cover = cover[rows, columns] * np.float32(color[3])
        bottom, right = top + rows.stop, left + columns.stop
        for plane, value in zip(self._painted, (*color[:3], 1.0), strict=True):
            region = plane[top + rows.start : bottom, left + columns.start : right]
            region += cover * (np.float32(value) - region)


def _rounded(width: int, height: int, radius: float) -> np.ndarray:
    """Return how much of each pixel a rectangle with rounded corners covers."""
    cover = np.ones((height, width), np.float32)
    radius = min(radius, width / 2.0, height / 2.0)
    size = int(np.ceil(radius))
    if size < 1:
        return cover
    away = radius - (np.arange(size) + 0.5)
    corner = np.clip(radius - np.hypot(away[:, None], away[None, :]) + 0.5, 0.0, 1.0)
    for rows, part in ((slice(size), corner), (slice(-size, None), corner[::-1])):
        cover[rows, :size] = np.minimum(cover[rows, :size], part)
        cover[rows, -size:] = np.minimum(cover[rows, -size:], part[:, ::-1])
    return cover


def _distance(x: np.ndarray, y: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    along = end - start
    length = float(along @ along) or 1.0
    share = np.clip(((x - start[0]) * along[0] + (y - start[1]) * along[1]) / length, 0.0, 1.0)
    return np.hypot(x - start[0] - share * along[0], y - start[1] - share * along[1])
