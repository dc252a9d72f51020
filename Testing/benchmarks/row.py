"""Rows of the bench's table; the speed of this machine, and what a process costs (Linux)."""

import os
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np

Figures = tuple[float, float]


def row(
    name: str,
    values: Sequence[float],
    unit: str,
    peer: str = "",
    others: Sequence[float] = (),
    *,
    success: float | None = None,
    n: int | None = None,
    worst: int = 99,
) -> dict:
    """Return the row of a measurement, with the keys of `__main__.COLUMNS`.

    `others` are the values of the `peer`; without them both its figures are left out. NaN stands
    for a missing value. `worst` is the percentile at the bad end, 1 where more is better.
    """
    return row_of_figures(
        name,
        _figures(values, worst),
        unit,
        peer=peer,
        peer_figures=_figures(others, worst) if len(others) else None,
        success=success,
        n=len(values) if n is None else n,
    )


def row_of_figures(
    name: str,
    figures: Figures,
    unit: str,
    *,
    peer: str = "",
    peer_figures: Figures | None = None,
    success: float | None = None,
    n: int,
) -> dict:
    """Return the row of a median and a 99th percentile that are known already."""
    peer_median, peer_p99 = peer_figures or (None, None)
    return {
        "name": name,
        "median": float(figures[0]),
        "p99": float(figures[1]),
        "unit": unit,
        "peer": peer or None,
        "peer_median": peer_median,
        "peer_p99": peer_p99,
        "success": success,
        "n": n,
    }


def _figures(values: Sequence[float], worst: int) -> Figures:
    return float(np.nanmedian(values)), float(np.nanpercentile(values, worst))


LOOPS, STEPS = 50, 200_000


def host_row(name: str) -> dict:
    """Return the row `host.NAME`: how long plain Python takes for a fixed sum, before a benchmark.

    A virtual machine whose host is busy runs at half speed for minutes; absolute figures of two
    runs can be compared only if this row is the same.
    """
    return row(f"host.{name}", [1e3 * _sum_time() for _ in range(LOOPS)], "ms")


def load_row(name: str) -> dict:
    """Return the row `load.NAME`: how many processes want a processor, over the last minute."""
    load = os.getloadavg()[0] if hasattr(os, "getloadavg") else float("nan")
    return row_of_figures(f"load.{name}", (load, load), f"of {os.cpu_count()}", n=1)


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
