"""How punctual the control loop of a running simulator is, by its heartbeat."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from rastrainer.igtl.client import Client
from rastrainer.protocol import DeviceName
from rastrainer_simulator.loop.timing import LoopStatistics

TIMEOUT_S = 60.0


@dataclass(frozen=True)
class Punctuality:
    """The ticks in a stretch of time.

    Attributes:
        shares: of ticks that were on time in each second, percent.
        on_time: of all ticks, 0…1.
        ticks: that were due.
    """

    shares: np.ndarray
    on_time: float
    ticks: int


def health_of(beat: Mapping[str, Any]) -> LoopStatistics:
    """Return the loop statistics of a heartbeat."""
    return LoopStatistics(beat["ticks"], beat["lateTicks"], beat["skippedTicks"])


def next_health(client: Client) -> LoopStatistics:
    """Wait for the next heartbeat, which comes once a second.

    Raises:
        LinkError: none came in a minute, or the connection is lost.
    """
    known = client.latest.get(DeviceName.SIM_SERVER)
    beat = client.wait_for(DeviceName.SIM_SERVER, lambda new: new is not known, TIMEOUT_S)
    return health_of(json.loads(beat.content.message))


def on_time(health: LoopStatistics) -> float:
    """Return the share of all ticks that were on time, 0…1; skipped ticks were not."""
    due = health.ticks + health.skipped
    return (health.ticks - health.late) / due if due else 1.0


def between(earlier: LoopStatistics, later: LoopStatistics) -> LoopStatistics:
    """Return the counts of the time between two heartbeats."""
    return LoopStatistics(
        later.ticks - earlier.ticks, later.late - earlier.late, later.skipped - earlier.skipped
    )


def punctuality(healths: Sequence[LoopStatistics]) -> Punctuality:
    """Return the punctuality between several heartbeats in a row."""
    return _of_parts([between(earlier, later) for earlier, later in pairwise(healths)])


def undisturbed(
    healths: Sequence[tuple[float, LoopStatistics]], was_never_late: Callable[[float, float], bool]
) -> Punctuality | None:
    """Return the punctuality in those seconds in which the machine took nothing away.

    In these seconds none of the other loops, which do nothing, was late. None if there is no such
    second.

    Args:
        healths: each with the time of its arrival (`time.monotonic`, s).
        was_never_late: whether a bare loop was never late between two such times.
    """
    parts = [
        between(earlier, later)
        for (start, earlier), (end, later) in pairwise(healths)
        if later.ticks > earlier.ticks and was_never_late(start, end)
    ]
    return _of_parts(parts) if parts else None


def _of_parts(parts: Sequence[LoopStatistics]) -> Punctuality:
    """Return the punctuality of stretches of about a second each."""
    whole = LoopStatistics(
        sum(part.ticks for part in parts),
        sum(part.late for part in parts),
        sum(part.skipped for part in parts),
    )
    shares = np.array([100.0 * on_time(part) for part in parts])
    return Punctuality(shares, on_time(whole), whole.ticks + whole.skipped)
