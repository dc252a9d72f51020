"""What an attack costs the process that is attacked: memory, descriptors, punctuality."""

from __future__ import annotations

import json
import re
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from rastrainer.igtl.client import Client
from rastrainer_simulator.loop_statistics import LoopStatistics
from Testing.benchmarks.bare_loop import BareLoop
from Testing.benchmarks.loop_health import health_of
from Testing.benchmarks.process_cost import resident_mb

MOST_GROWTH_MB = 8.0
"""What an attack leaves behind after another like it has warmed the process up."""
MOST_MORE_DESCRIPTORS = 4
"""An attack may have started a trial, whose journal is then open."""
MOST_MORE_MISSED = 0.5
"""Of the ticks, beside a loop that does nothing: coarse, for a slow machine makes a loop that works
late sooner than one that does not. The share itself is printed."""
PATIENCE_S = 30.0
COUNTED = re.compile(r"(\d+) × 127\.0\.0\.1: ([^;\n]+)")


@dataclass(frozen=True)
class Cost:
    """Of a process at one moment: MB in use, open descriptors, the control loop's ticks so far."""

    resident_mb: float
    descriptors: int
    loop: LoopStatistics


def cost_of(pid: int, client: Client) -> Cost:
    """Return what a simulator costs now, as Linux and its own heartbeat tell it."""
    old = client.latest.get("SimServer")
    beat = json.loads(client.wait_for("SimServer", lambda now: now is not old).content.message)
    descriptors = len(list(Path(f"/proc/{pid}/fd").iterdir()))
    return Cost(resident_mb(pid), descriptors, health_of(beat))


def settled(pid: int, client: Client, wanted: Cost) -> Cost:
    """Return the cost once the attack's connections are gone, or as it stays."""
    end = time.monotonic() + PATIENCE_S
    while True:
        cost = cost_of(pid, client)
        if cost.descriptors <= wanted.descriptors + MOST_MORE_DESCRIPTORS or time.monotonic() > end:
            return cost


def told(before: Cost, after: Cost, bare: BareLoop) -> str:
    """Return in words what has changed, the share of ticks on time among it.

    `bare` is a loop that did nothing beside it: where that is late, the machine is to blame.
    """
    meanwhile = after.loop.since(before.loop)
    return (
        f"{100.0 * meanwhile.on_time:.3f} % of {meanwhile.ticks} ticks on time "
        f"({100.0 * bare.punctuality.on_time:.3f} % of a loop that does nothing), "
        f"{after.resident_mb - before.resident_mb:+.1f} MB, "
        f"{after.descriptors - before.descriptors:+d} descriptors"
    )


def check_unharmed(before: Cost, after: Cost, bare: BareLoop) -> None:
    """Check that an attack has left nothing behind and has not kept the loop from its ticks."""
    assert after.descriptors <= before.descriptors + MOST_MORE_DESCRIPTORS
    assert after.resident_mb - before.resident_mb <= MOST_GROWTH_MB
    on_time = after.loop.since(before.loop).on_time
    assert on_time >= bare.punctuality.on_time - MOST_MORE_MISSED


def counted_in_log(said: str) -> Counter[str]:
    """Return how often the link's log tells of each trouble."""
    counts: Counter[str] = Counter()
    for times, trouble in COUNTED.findall(said):
        counts[trouble] += int(times)
    return counts
