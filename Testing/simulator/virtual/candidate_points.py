"""Where the next point may be, by all that was read: positions on a head of average size."""

from __future__ import annotations

import math

import numpy as np

from rastrainer_simulator.flow.arm_screen import BACK_WITHIN, FARTHEST

CENTER = np.array([0.47, 0.0, 0.215])
"""Where a head is on the stand, World, m: every trial turns and moves it a little."""
HALF_AXES = np.array([0.08, 0.103, 0.1])
LOWEST_M = -0.06
"""No point is deeper than this below its middle."""
PLACES = 3000
"""Positions on the whole head are 6 mm from their neighbors."""
UNSURE_M = 0.012
"""The largest error of the counted movements."""
AROUND_M = 0.0075
"""The point is farther than this from where a touch does not count."""
COUNTS_M = 0.01
"""Within this a touch counts, as a refusal tells."""


def outward(place: np.ndarray) -> np.ndarray:
    """Return the direction out of the head at a position, (3,) float, a unit vector."""
    normal = (place - CENTER) / HALF_AXES**2
    return normal / np.linalg.norm(normal)


def surface_at(place: np.ndarray) -> np.ndarray:
    """Return the position on the skin under a position, (3,) float, m."""
    from_center = place - CENTER
    return CENTER + from_center / np.linalg.norm(from_center / HALF_AXES)


class CandidatePoints:
    """The positions where the next point may be; all are (3,) float, World, m.

    Attributes:
        all: (n, 3) float, of the whole head.
        needs_answers: whether refusals of touches tell more than they hide: after one, it is not
            read whether the tip is off the path.
    """

    def __init__(self) -> None:
        golden = math.pi * (3.0 - math.sqrt(5.0))
        z = 1.0 - 2.0 * (np.arange(PLACES) + 0.5) / PLACES
        turn = golden * np.arange(PLACES)
        level = np.sqrt(1.0 - z**2)
        directions = np.column_stack((level * np.cos(turn), level * np.sin(turn), z))
        places = CENTER + HALF_AXES * directions
        self.all = places[places[:, 2] > CENTER[2] + LOWEST_M]
        self._is_open = np.ones(len(self.all), bool)
        self._is_empty = np.zeros(len(self.all), bool)
        self._known: dict[str, tuple[float, np.ndarray]] = {}
        self._last: np.ndarray | None = None
        self._was_off = False
        self._label = "1"
        self.needs_answers = True

    def nearest(self, at: np.ndarray) -> np.ndarray:
        """Return the nearest position where the point may be; if none is left, reopen all."""
        if not self._is_open.any():
            self.needs_answers = True
            self._is_open[:] = ~self._is_empty
            self._known.pop(self._label, None)
            if not self._is_open.any():
                self._is_empty[:], self._is_open[:] = False, True
        away = np.linalg.norm(self.all - at, axis=1)
        return self.all[int(np.argmin(np.where(self._is_open, away, np.inf)))]

    def may_be_at(self, place: np.ndarray) -> bool:
        """Return whether the point may be at one of the positions."""
        return bool(self._is_open[np.argmin(np.linalg.norm(self.all - place, axis=1))])

    def is_silent_at(self, at: np.ndarray) -> bool:
        """Return whether no message is shown on the skin there: the last touch was."""
        return self._last is not None and bool(np.linalg.norm(at - self._last) < COUNTS_M)

    def has_touched(self, at: np.ndarray, following: str) -> None:
        """Begin to search for the point that follows the point touched there."""
        self._last, self._label, self._was_off = at, following, False
        self.needs_answers = False
        self._is_empty |= self._away(surface_at(at)) < AROUND_M
        self._is_open = ~self._is_empty
        if following in self._known:
            self._keep(self._away(self._known[following][1]) < 0.02)

    def is_of(self, at: np.ndarray, label: str, away_m: float) -> None:
        """Remember where another point is, so far away."""
        if label not in self._known or away_m < self._known[label][0]:
            self._known[label] = away_m, at

    def is_refused(self, at: np.ndarray, away_m: float, is_farther: bool) -> None:
        """No point is near there; the next one is so far away, or farther than that."""
        self._is_empty |= self._away(surface_at(at)) < AROUND_M
        away = self._away(at)
        if is_farther:
            self._keep(away > away_m - UNSURE_M)
        else:
            self._keep(np.abs(away - away_m) < UNSURE_M)

    def is_not_at(self, at: np.ndarray) -> None:
        """The point is not near there."""
        self._keep(self._away(surface_at(at)) > AROUND_M)

    def cannot_reach(self, place: np.ndarray) -> None:
        """The tip does not reach one of the positions."""
        self._is_open[np.argmin(self._away(place))] = False

    def is_within(self, at: np.ndarray, most_m: float) -> None:
        """The point is not farther away than that."""
        self._keep(self._away(at) < most_m + UNSURE_M)

    def is_away(self, at: np.ndarray, shown_m: float, direction: np.ndarray) -> None:
        """The point is about that far away, in about that direction."""
        is_ahead = (self.all - at) @ direction > -UNSURE_M
        self._keep((np.abs(self._away(at) - shown_m) < 0.0025 + UNSURE_M) & is_ahead)

    def is_off_path(self, at: np.ndarray) -> None:
        """The tip is next to the path from the last point to the next."""
        least = BACK_WITHIN if self._was_off else FARTHEST
        self._was_off = True
        self._keep(self._beside(at) > least - UNSURE_M)

    def is_on_path(self, at: np.ndarray) -> None:
        """The tip is not next to that path."""
        most = BACK_WITHIN if self._was_off else FARTHEST
        self._was_off = False
        if self._last is not None:
            self._keep(self._beside(at) < most + UNSURE_M)

    def _away(self, at: np.ndarray) -> np.ndarray:
        return np.linalg.norm(self.all - at, axis=1)

    def _keep(self, agrees: np.ndarray) -> None:
        self._is_open &= agrees

    def _beside(self, at: np.ndarray) -> np.ndarray:
        """Return how far a tip is from the path to each position, (n,) float, m."""
        assert self._last is not None, "there is no path to the first point"
        first, here = _unit(self._last - CENTER), _unit(at - CENTER)
        ends = (self.all - CENTER) / np.linalg.norm(self.all - CENTER, axis=1)[:, None]
        poles = np.cross(first, ends)
        poles /= np.maximum(1e-9, np.linalg.norm(poles, axis=1))[:, None]
        is_between = (np.cross(poles, first) @ here >= 0.0) & (np.cross(ends, poles) @ here >= 0.0)
        to_ends = np.minimum(
            math.acos(np.clip(here @ first, -1.0, 1.0)), np.arccos(np.clip(ends @ here, -1.0, 1.0))
        )
        beside = np.where(is_between, np.abs(np.arcsin(np.clip(poles @ here, -1.0, 1.0))), to_ends)
        return float(np.linalg.norm(at - CENTER)) * beside


def _unit(vector: np.ndarray) -> np.ndarray:
    return vector / np.linalg.norm(vector)
