"""The speed of this machine at the moment, and what a process costs (Linux)."""

import os
import time
from pathlib import Path

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


def cpu_share(pid: int, seconds: float) -> float:
    """Return the share of one core that a process uses in the next `seconds`."""
    begin, used = time.perf_counter(), _cpu_time(pid)
    time.sleep(seconds)
    return (_cpu_time(pid) - used) / (time.perf_counter() - begin)


def resident_mb(pid: int) -> float:
    """Return the memory that a process has in use, MB."""
    pages = int(Path(f"/proc/{pid}/statm").read_text().split()[1])
    return pages * os.sysconf("SC_PAGE_SIZE") / 1e6


def _cpu_time(pid: int) -> float:
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
