"""What spectators are told of who wears a headset: where eyes and hands are, never pixels."""

from __future__ import annotations

from rastrainer_simulator.net.views import outgoing
from rastrainer_simulator.net.views.messages import Worn

NOBODY = "null"


class Mirror:
    """Keeps what the newest headset has told; one that comes back is another view."""

    def __init__(self) -> None:
        self._headsets: set[int] = set()
        self.text = NOBODY
        """JSON of what the newest headset told last; "null" without one that is worn."""

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
        """Take what a headset tells; only the newest is followed."""
        if view == max(self._headsets, default=None):
            self.text = NOBODY if worn.eyes is None else outgoing.wearer(worn)
