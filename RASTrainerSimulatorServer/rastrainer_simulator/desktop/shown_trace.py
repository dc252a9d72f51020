"""What was traced over the skin as the simulator sends it, and how it is painted on the skin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from rastrainer.registration.surface_error import nearest_traced_mm
from rastrainer.transforms import MM_PER_M

FULL_SHARE = 0.5
"""Up to this share of the covered distance the paint is full; from there on it fades."""


@dataclass(frozen=True, eq=False)
class ShownTrace:
    """A trace, in the head's frame, m.

    Attributes:
        points: (n, 3) float.
        kept: how many of them were known before the last news.
        covered: so far around them the skin is painted; 0 where it is not.
        place: position and outward normal of the place to draw next; None without one.
    """

    points: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    kept: int = 0
    covered: float = 0.0
    place: tuple[np.ndarray, np.ndarray] | None = None

    def with_update(self, message: Mapping[str, Any]) -> ShownTrace:
        """Return the trace after a `trace` message.

        Raises:
            ValueError, KeyError, TypeError: it is none.
        """
        kept = min(int(message["known"]), len(self.points))
        new = np.array(message["points"], dtype=float).reshape(-1, 3) / MM_PER_M
        place = message["next"]
        if place is not None:
            position, normal = (np.array(place[key], float) for key in ("positionMm", "normal"))
            place = position / MM_PER_M, normal
        points = np.concatenate([self.points[:kept], new])
        return ShownTrace(points, kept, float(message["coveredMm"]) / MM_PER_M, place)


class SkinPaint:
    """The paint around a trace.

    Attributes:
        shares: (v,) float, 0 to 1, how much of the paint covers each vertex; None without any.
    """

    def __init__(self) -> None:
        self.shares: np.ndarray | None = None
        self._points = np.zeros((0, 3))
        self._away = np.zeros(0)

    def cover(self, vertices: np.ndarray, trace: ShownTrace) -> bool:
        """Cover the vertices (v, 3), m, around a trace; return whether the paint has changed."""
        known = min(len(self._points), len(trace.points))
        if len(self._points) > known or not np.array_equal(trace.points[:known], self._points):
            known = 0
        if known == 0:
            self._away = np.full(len(vertices), np.inf)
        had_any, is_new = self.shares is not None, len(trace.points) != len(self._points)
        self._away = nearest_traced_mm(vertices, trace.points[known:], self._away)
        self._points = trace.points
        if not trace.covered or not len(trace.points):
            self.shares = None
            return had_any
        fading = (1.0 - self._away / trace.covered) / (1.0 - FULL_SHARE)
        self.shares = np.clip(fading, 0.0, 1.0)
        return is_new or known == 0 or not had_any
