"""How far drill and instrument were in the guide, by the entries of a journal."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from rastrainer.protocol import Phase
from rastrainer.transforms import MM_PER_M
from rastrainer_simulator.core.procedure_motion import FED
from rastrainer_simulator.training.feed import NO_FEED, Feed, HeadAhead


class RecordedFeed:
    """Follows the feed through a journal's entries.

    Attributes:
        feed: after the entries taken so far.
    """

    def __init__(self) -> None:
        self.feed = NO_FEED
        self._ahead = HeadAhead()
        self._stage = Phase.RUNNING

    def before(self, effect: Mapping[str, Any]) -> Feed:
        """Return the feed at which a command had an effect."""
        ahead = _ahead(effect) or self._ahead
        drilled = metres(effect.get("drilledMm", 0.0))
        return Feed(metres(effect.get("feedMm", 0.0)), drilled, ahead)

    def take(self, entry: Mapping[str, Any]) -> None:
        """Take the next entry."""
        if entry["kind"] == "sample" and "feedMm" in entry:
            depth = metres(entry["feedMm"])
            deepest = depth if self._stage is Phase.DRILLING else 0.0
            drilled = max(self.feed.drilled, deepest)
            self.feed = replace(self.feed, depth=depth, drilled=drilled)
        elif entry["kind"] == "phase" and "procedure" in entry:
            self._enter(entry, Phase(entry["procedure"]["stage"]))

    def _enter(self, entry: Mapping[str, Any], stage: Phase) -> None:
        is_exchanged = self._stage is Phase.DRILLING and stage is Phase.INSERTING
        feed = self.before(entry)
        self._stage, self._ahead = stage, feed.ahead
        if stage not in FED:
            self.feed = NO_FEED
        else:
            self.feed = replace(feed, depth=0.0) if is_exchanged else feed


def _ahead(effect: Mapping[str, Any]) -> HeadAhead | None:
    """Return what lay ahead of the guide when it was locked; None of any other effect."""
    if "ahead" not in effect:
        return None
    found = effect["ahead"]
    names = ("skinMm", "outerMm", "innerMm")
    return HeadAhead(*(None if found[name] is None else metres(found[name]) for name in names))


def metres(value_mm: float) -> float:
    """Return the number that times 1000 is the given one to the last bit."""
    near = value_mm / MM_PER_M
    candidates = (near, math.nextafter(near, math.inf), math.nextafter(near, -math.inf))
    return next((each for each in candidates if MM_PER_M * each == value_mm), near)
