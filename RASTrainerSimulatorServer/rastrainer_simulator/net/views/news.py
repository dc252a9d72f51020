"""What all views are sent beside the state: the news of a trace, and of who wears a headset."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import takewhile

import numpy as np

from rastrainer.protocol import OPEN_PHASES, PROCEDURE_PHASES
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.loop.timing import Pacer
from rastrainer_simulator.net.views import outgoing
from rastrainer_simulator.net.views.messages import Worn
from rastrainer_simulator.net.views.presenter import TraceGuidance
from rastrainer_simulator.state import SimulationState
from rastrainer_simulator.trial_state import TracedPoint

NEWS_HZ = 5.0


class TraceNews:
    """The trace as all views know it; each message has only what they do not know."""

    def __init__(self) -> None:
        self._points: tuple[TracedPoint, ...] = ()
        self._places: list[list[float]] = []
        self._guidance = TraceGuidance()
        self._pacer = Pacer(NEWS_HZ)

    def news(self, now: SimulationState, guidance: TraceGuidance, time_s: float) -> str | None:
        """Return what is new, as a message; None where nothing is, or it is too early to send it.

        Args:
            now: a state.
            guidance: in that state.
            time_s: by which the messages are paced.
        """
        trace, phase = now.training.trace, now.training.phase
        is_shown = trace is not None and phase in OPEN_PHASES and phase not in PROCEDURE_PHASES
        points = trace.points if trace is not None and is_shown else ()
        wanted = guidance if is_shown else TraceGuidance()
        is_known = points is self._points or points == self._points
        if (is_known and wanted == self._guidance) or not self._pacer.is_due(time_s):
            return None
        known = sum(1 for _ in takewhile(_is_same, zip(self._points, points, strict=False)))
        new = _in_head([point.seen for point in points[known:]], now.head_to_world)
        self._points, self._guidance = points, wanted
        self._places = [*self._places[:known], *new]
        return outgoing.trace(known, new, wanted)

    def everything(self) -> str | None:
        """Return all that has been sent, for a view that has just joined; None for nothing."""
        if not self._places and self._guidance == TraceGuidance():
            return None
        return outgoing.trace(0, self._places, self._guidance)


def _is_same(pair: tuple[TracedPoint, TracedPoint]) -> bool:
    return pair[0] is pair[1] or pair[0] == pair[1]


def _in_head(places: Sequence[Sequence[float]], head_to_world: np.ndarray) -> list[list[float]]:
    """Return places (World, m) in the head's frame, mm."""
    if not places:
        return []
    away = np.array(places) - head_to_world[:3, 3]
    found: list[list[float]] = np.round(MM_PER_M * away @ head_to_world[:3, :3], 2).tolist()
    return found


NOBODY = "null"


class Mirror:
    """Keeps what the newest headset has sent; one that comes back is another view."""

    def __init__(self) -> None:
        self._headsets: set[int] = set()
        self.text = NOBODY
        """JSON of what the newest headset sent last; "null" without one that is worn."""

    def joined(self, view: int) -> None:
        """Follow a headset from now on."""
        self._headsets.add(view)
        self.text = NOBODY

    def left(self, view: int) -> None:
        """Forget a view; the one before it, if any, is followed again."""
        if view in self._headsets and view == max(self._headsets):
            self.text = NOBODY
        self._headsets.discard(view)

    def take(self, view: int, worn: Worn) -> None:
        """Take what a headset sends; only the newest is followed."""
        if view == max(self._headsets, default=None):
            self.text = NOBODY if worn.eyes is None else outgoing.wearer(worn)
