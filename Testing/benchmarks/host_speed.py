"""How fast this machine is at the moment: a slow minute is told from a slow program."""

from __future__ import annotations

import time

from Testing.benchmarks.row import row

LOOPS, STEPS = 50, 200_000


def host_row(name: str) -> dict:
    """Return the row `host.NAME`: how long plain Python takes for a fixed sum, before a benchmark.

    A virtual machine whose host is busy runs at half speed for minutes; absolute figures of two
    runs can be compared only where this row is the same.
    """
    return row(f"host.{name}", [1e3 * _sum_time() for _ in range(LOOPS)], "ms")


def _sum_time() -> float:
    begin = time.perf_counter()
    total = 0
    for number in range(STEPS):
        total += number * number % 7
    return time.perf_counter() - begin
