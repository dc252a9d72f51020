"""The computer's clocks, its scheduler and its ports."""

from __future__ import annotations

import contextlib
import os
import socket
import sys
import time
from collections.abc import Iterator
from datetime import datetime, timedelta, timezone
from pathlib import Path

from rastrainer.protocol import DEFAULT_HOST
from rastrainer_simulator.cli.doctor.check_result import CheckResult, CheckStatus
from rastrainer_simulator.loop.precise_clock import is_real_time_permitted
from rastrainer_simulator.net.listener import listening_socket
from rastrainer_simulator.record.trial_archive import SUFFIX

COARSEST_S = 0.001
EARLIEST = datetime(2025, 1, 1, tzinfo=timezone.utc)
"""A correct clock shows a later date."""
SET_IT = "Set the clock, and let the system keep it by network time (NTP)."

_STAMP = "%Y%m%dT%H%M%SZ"


def check_clock(records: Path, now: datetime | None = None) -> Iterator[CheckResult]:
    """Check both clocks; the journals in `records` show whether the date was set back."""
    now = now or datetime.now(timezone.utc)
    resolution = time.get_clock_info("monotonic").resolution
    if resolution > COARSEST_S and time.get_clock_info("perf_counter").resolution > COARSEST_S:
        sentence = f"The clock for durations counts in steps of {1000.0 * resolution:.0f} ms."
        yield CheckResult(
            "clock", CheckStatus.WARNING, sentence, "Use a newer system: ticks would be late."
        )
    newest = max(
        (stamp for path in records.glob(f"*{SUFFIX}") if (stamp := _stamp(path))), default=now
    )
    date = f"{now:%Y-%m-%d %H:%M:%S} UTC"
    if now < EARLIEST:
        yield CheckResult("clock", CheckStatus.WARNING, f"It cannot be {date} already.", SET_IT)
    elif newest > now + timedelta(minutes=1):
        wrong = f"It is {date}, but a trial was recorded at {newest:%Y-%m-%d %H:%M:%S} UTC."
        yield CheckResult("clock", CheckStatus.WARNING, f"{wrong} The clock was set back.", SET_IT)
    else:
        yield CheckResult("clock", CheckStatus.OK, f"It is {date}.")


def _stamp(path: Path) -> datetime | None:
    with contextlib.suppress(ValueError):
        return datetime.strptime(path.name.partition("_")[0], _STAMP).replace(tzinfo=timezone.utc)
    return None


def check_real_time() -> Iterator[CheckResult]:
    """Try real-time priority, as the control loop will."""
    if not hasattr(os, "SCHED_FIFO"):
        answer = "is given to everyone" if sys.platform == "win32" else "is not used"
        yield CheckResult(
            "real time", CheckStatus.OK, f"Real-time priority {answer} on this system."
        )
        return
    if is_real_time_permitted():
        yield CheckResult("real time", CheckStatus.OK, "Real-time priority is permitted.")
        return
    yield CheckResult(
        "real time",
        CheckStatus.WARNING,
        "Real-time priority is not permitted: on a busy machine the arm may stutter.",
        "Add the line `@audio - rtprio 20` (or your group) to /etc/security/limits.conf and "
        "log in again; `ulimit -r` then prints 20.",
    )


_LISTENS = "0A"


def check_ports(link: int, views: int) -> Iterator[CheckResult]:
    """Try the port of OpenIGTLink, and the one that views are served on."""
    yield _link(link)
    yield _views(views)


def _link(port: int) -> CheckResult:
    reason = _refusal(port)
    if reason is None:
        return CheckResult("ports", CheckStatus.OK, f"Port {port} for OpenIGTLink is free.")
    return CheckResult(
        "ports",
        CheckStatus.PROBLEM,
        f"Port {port} for OpenIGTLink cannot be used: {reason}.",
        "End that program, or choose another port: rastrainer simulator --port NUMBER, and the "
        "same in Slicer.",
    )


def _views(port: int) -> CheckResult:
    reason = _refusal(port)
    if reason is None:
        return CheckResult("ports", CheckStatus.OK, f"Port {port} for the views is free.")
    return CheckResult(
        "ports",
        CheckStatus.WARNING,
        f"Port {port} for the views cannot be used: {reason}.",
        "The simulator uses another one and prints it; end that program to free this one.",
    )


def _refusal(port: int) -> str | None:
    """Return why a port of this computer cannot be listened on, None where it can."""
    try:
        listening_socket(socket.AF_INET, (DEFAULT_HOST, port)).close()
    except OSError as error:
        holder = _holder(port)
        return f"{holder} holds it" if holder else (error.strerror or str(error)).lower()
    except OverflowError:
        return "a port is a number from 0 to 65535"
    return None


def _holder(port: int) -> str:
    """Return the program that listens on a port, "" if unknown (as on all systems but Linux)."""
    inodes = {f"socket:[{inode}]" for inode in _listening(port)}
    if not inodes:
        return ""
    for process in Path("/proc").glob("[0-9]*"):
        # Of other users' processes it is only known that they are there.
        with contextlib.suppress(OSError):
            for descriptor in (process / "fd").iterdir():
                if str(descriptor.readlink()) in inodes:
                    return f"{_command(process)} (process {process.name})"
    return "a program of another user"


def _listening(port: int) -> Iterator[str]:
    """Yield the inodes of the sockets that listen on a port."""
    for table in (Path("/proc/net/tcp"), Path("/proc/net/tcp6")):
        with contextlib.suppress(OSError):
            for line in table.read_text().splitlines()[1:]:
                words = line.split()
                if words[3] == _LISTENS and int(words[1].rpartition(":")[2], 16) == port:
                    yield words[9]


def _command(process: Path) -> str:
    words = (process / "cmdline").read_bytes().decode(errors="replace").split("\0")
    return " ".join(Path(word).name for word in words[:4] if word) or "a program"
