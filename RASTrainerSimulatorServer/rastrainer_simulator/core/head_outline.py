"""How far the skin is from the middle of the head in each direction, roughly and quickly."""

from __future__ import annotations

import math

import numpy as np

from rastrainer_simulator.vectors import Vector

_BANDS = 12
"""Of latitude; there are twice as many sectors of longitude."""


class HeadOutline:
    """The greatest distance of the skin from the middle of the head, by sectors of 15°.

    Attributes:
        middle: of the head, RAS mm.
    """

    def __init__(self, vertices: np.ndarray, middle: np.ndarray) -> None:
        """Take the head's vertices, (n, 3) float, and its middle, (3,) float, RAS mm."""
        self.middle = middle
        out = vertices - middle
        radii = np.linalg.norm(out, axis=1)
        bands, sectors = _sectors(out / radii[:, None])
        table = np.zeros((_BANDS, 2 * _BANDS))
        np.maximum.at(table, (bands, sectors), radii)
        # A direction may lie at the edge of its sector: the neighbors count, too.
        wide = np.maximum.reduce([np.roll(table, turn, axis=1) for turn in (-1, 0, 1)])
        tall = np.pad(wide, ((1, 1), (0, 0)), mode="edge")
        # Whole millimeters: the same on every computer.
        radii_mm = np.ceil(np.maximum.reduce([tall[:-2], tall[1:-1], tall[2:]]))
        for pole in (0, -1):
            radii_mm[pole] = radii_mm[pole].max()
        self._radii = (radii_mm / 1000.0).tolist()

    def radius(self, direction: Vector) -> float:
        """Return the distance in a direction (unit vector in the head's frame), m."""
        x, y, z = direction
        band = _BANDS * math.acos(min(max(z, -1.0), 1.0)) / math.pi
        sector = _BANDS * (math.atan2(y, x) + math.pi) / math.pi
        return self._radii[min(int(band), _BANDS - 1)][min(int(sector), 2 * _BANDS - 1)]


def _sectors(directions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the band and the sector of unit vectors, (n,) int each."""
    x, y, z = directions.T
    bands = (_BANDS * np.arccos(np.clip(z, -1.0, 1.0)) / np.pi).astype(int)
    sectors = (_BANDS * (np.arctan2(y, x) + np.pi) / np.pi).astype(int)
    return np.minimum(bands, _BANDS - 1), np.minimum(sectors, 2 * _BANDS - 1)
