"""What a process costs, as Linux tells it."""

from __future__ import annotations

import os
import time
from pathlib import Path


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
