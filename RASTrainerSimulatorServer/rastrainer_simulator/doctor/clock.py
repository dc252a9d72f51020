"""The clocks: one counts durations, the other dates records."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from datetime import datetime, timedelta, timezone
from pathlib import Path

from rastrainer_simulator.doctor.finding import Finding, Verdict
from rastrainer_simulator.record.trial_archive import SUFFIX

COARSEST_S = 0.001
EARLIEST = datetime(2025, 1, 1, tzinfo=timezone.utc)
"""No clock that is right tells an earlier date."""
SET_IT = "Set the clock, and let the system keep it by network time (NTP)."

_STAMP = "%Y%m%dT%H%M%SZ"


def check_clock(records: Path, now: datetime | None = None) -> Iterator[Finding]:
    """Judge both clocks; the journals in `records` tell whether the date was set back."""
    now = now or datetime.now(timezone.utc)
    resolution = time.get_clock_info("monotonic").resolution
    if resolution > COARSEST_S and time.get_clock_info("perf_counter").resolution > COARSEST_S:
        told = f"The clock for durations counts in steps of {1000.0 * resolution:.0f} ms."
        yield Finding("clock", Verdict.WARNING, told, "Use a newer system: ticks would be late.")
    newest = max(
        (stamp for path in records.glob(f"*{SUFFIX}") if (stamp := _stamp(path))), default=now
    )
    date = f"{now:%Y-%m-%d %H:%M:%S} UTC"
    if now < EARLIEST:
        yield Finding("clock", Verdict.WARNING, f"It cannot be {date} already.", SET_IT)
    elif newest > now + timedelta(minutes=1):
        told = f"It is {date}, but a trial was recorded at {newest:%Y-%m-%d %H:%M:%S} UTC."
        yield Finding("clock", Verdict.WARNING, f"{told} The clock was set back.", SET_IT)
    else:
        yield Finding("clock", Verdict.OK, f"It is {date}.")


def _stamp(path: Path) -> datetime | None:
    with contextlib.suppress(ValueError):
        return datetime.strptime(path.name.partition("_")[0], _STAMP).replace(tzinfo=timezone.utc)
    return None
