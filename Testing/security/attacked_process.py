"""The cost of an attack to the attacked process: memory and descriptors."""

import re
import time
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

from rastrainer.igtl.client import Client
from Testing.benchmarks.loop_health import next_health
from Testing.benchmarks.row import resident_mb

MAX_GROWTH_MB = 8.0
"""What an attack leaves behind after a similar one has warmed up the process."""
MAX_MORE_DESCRIPTORS = 4
"""An attack may have started a trial, whose journal is then open."""
TIMEOUT_S = 120.0
COUNTED = re.compile(r"(\d+) × 127\.0\.0\.1: ([^;\n]+)")


@dataclass(frozen=True)
class Cost:
    """A process at one moment: MB in use and open descriptors."""

    resident_mb: float
    descriptors: int


def cost_of(pid: int, client: Client) -> Cost:
    """Return what a simulator costs, by Linux, after its next heartbeat."""
    next_health(client)
    descriptors = len(list(Path(f"/proc/{pid}/fd").iterdir()))
    return Cost(resident_mb(pid), descriptors)


def settled(pid: int, client: Client, wanted: Cost) -> Cost:
    """Return the cost once the attack's connections are gone, or as it stays."""
    end = time.monotonic() + TIMEOUT_S
    while True:
        cost = cost_of(pid, client)
        if cost.descriptors <= wanted.descriptors + MAX_MORE_DESCRIPTORS or time.monotonic() > end:
            return cost


def is_unharmed(before: Cost, after: Cost) -> bool:
    """Return whether an attack has left nothing behind."""
    has_grown = after.resident_mb - before.resident_mb > MAX_GROWTH_MB
    return not has_grown and after.descriptors <= before.descriptors + MAX_MORE_DESCRIPTORS


def counted_in_log(said: str) -> Counter[str]:
    """Return how often the link's log reports each problem."""
    counts: Counter[str] = Counter()
    for times, trouble in COUNTED.findall(said):
        counts[trouble] += int(times)
    return counts
