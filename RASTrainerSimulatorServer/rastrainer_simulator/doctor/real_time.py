"""Whether the control loop may run before all other programs."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator

from rastrainer_simulator.doctor.finding import Finding, Verdict
from rastrainer_simulator.precise_clock import is_real_time_permitted


def check_real_time() -> Iterator[Finding]:
    """Try real-time priority, as the control loop will."""
    if not hasattr(os, "SCHED_FIFO"):
        told = "is given to everyone" if sys.platform == "win32" else "is not asked for"
        yield Finding("real time", Verdict.OK, f"Real-time priority {told} on this system.")
        return
    if is_real_time_permitted():
        yield Finding("real time", Verdict.OK, "Real-time priority is permitted.")
        return
    yield Finding(
        "real time",
        Verdict.WARNING,
        "Real-time priority is not permitted: on a busy machine the arm may stutter.",
        "Add the line `@audio - rtprio 20` (or your group) to /etc/security/limits.conf and "
        "log in anew; `ulimit -r` then tells 20.",
    )
