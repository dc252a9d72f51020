"""The computer's clocks, its scheduler, its ports, and whether its folders can be used."""

from __future__ import annotations

import contextlib
import os
import shutil
import socket
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from datetime import datetime, timedelta, timezone
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.protocol import DEFAULT_HOST
from rastrainer_simulator.cli.doctor.check_result import CheckResult, CheckStatus
from rastrainer_simulator.core.interrupted_trial import find_interrupted
from rastrainer_simulator.flow.session.preferences import PREFERENCES_FILE, read_preferences
from rastrainer_simulator.input.bindings import BINDINGS_FILE, read_bindings
from rastrainer_simulator.loop.timing import is_real_time_permitted
from rastrainer_simulator.net.limits import read_limits
from rastrainer_simulator.net.listener import listening_socket
from rastrainer_simulator.record.trial_archive import SUFFIX, TrialArchive

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
    yield _port(
        link,
        "OpenIGTLink",
        CheckStatus.PROBLEM,
        "End that program, or choose another port: rastrainer simulator --port NUMBER, and the "
        "same in Slicer.",
    )
    yield _port(
        views,
        "the views",
        CheckStatus.WARNING,
        "The simulator uses another one and prints it; end that program to free this one.",
    )


def _port(port: int, what: str, verdict: CheckStatus, remedy: str) -> CheckResult:
    """Return whether a port is free; the verdict and the remedy are for one that is not."""
    reason = _refusal(port)
    if reason is None:
        return CheckResult("ports", CheckStatus.OK, f"Port {port} for {what} is free.")
    return CheckResult(
        "ports", verdict, f"Port {port} for {what} cannot be used: {reason}.", remedy
    )


def _refusal(port: int) -> str | None:
    """Return why a port of this computer cannot be used, or None if it can."""
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
        # Other users' processes are visible, but not their sockets.
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


MEGABYTE = 1_000_000
TRIAL_MB = 6.0
"""A journal of a long trial."""
PROBLEM_MB = 100.0
WARNING_MB = 1000.0


def check_folders(folders: Mapping[str, Path]) -> Iterator[CheckResult]:
    for purpose, folder in folders.items():
        yield _check(purpose, folder)


def _check(purpose: str, folder: Path) -> CheckResult:
    existing = _existing(folder)
    try:
        if existing != folder and not existing.is_dir():
            raise NotADirectoryError(20, f"{existing} is a file")
        with tempfile.TemporaryFile(dir=existing):
            pass
        free_mb = shutil.disk_usage(existing).free / MEGABYTE
    except OSError as error:
        return CheckResult(
            "folders",
            CheckStatus.PROBLEM,
            f"The folder of the {purpose}, {folder}, cannot be written to: {error.strerror}.",
            f"Allow writing to {existing}, or choose another folder: rastrainer simulator --help",
        )
    room = f"The folder of the {purpose}, {folder}, can be written to; {free_mb:,.0f} MB are free"
    if free_mb < PROBLEM_MB:
        return CheckResult("folders", CheckStatus.PROBLEM, f"{room}: too few.", "Free some space.")
    if free_mb < WARNING_MB:
        trials = int(free_mb / TRIAL_MB)
        sentence = f"{room}, enough for about {trials} trials."
        return CheckResult("folders", CheckStatus.WARNING, sentence, "Free some space.")
    return CheckResult("folders", CheckStatus.OK, f"{room}.")


def _existing(folder: Path) -> Path:
    """Return the folder, or the nearest one above it that exists."""
    with contextlib.suppress(OSError):
        for candidate in (folder, *folder.absolute().parents):
            if candidate.exists():
                return candidate
    return folder


def check_settings(config: Path) -> Iterator[CheckResult]:
    """Read each existing file of the settings."""
    try:
        read_limits(config)
    except InputError as error:
        remedy = "Fix the file, or delete it to use the default limits."
        yield CheckResult("settings", CheckStatus.PROBLEM, f"No simulator starts: {error}", remedy)
    readers = {PREFERENCES_FILE: read_preferences, BINDINGS_FILE: read_bindings}
    for name, read in readers.items():
        try:
            if (config / name).exists():
                read(config / name)
        except InputError as error:
            remedy = "Choose them again in the trainee's menu, which rewrites the file."
            yield CheckResult(
                "settings", CheckStatus.WARNING, f"The defaults are used: {error}", remedy
            )


KEEP_IT = "Keep the file unchanged; `rastrainer verify` and its path show how far it can be read."


def check_journals(records: Path) -> Iterator[CheckResult]:
    """Read the journals that a simulator reads when it starts: those to deliver, and the newest."""
    archive = TrialArchive(records)
    problems = dict.fromkeys(archive.problems)
    try:
        find_interrupted(records)
    except InputError as error:
        problems[str(error)] = None
    for problem in problems:
        yield CheckResult("journals", CheckStatus.WARNING, problem, KEEP_IT)
    if not problems:
        waiting = len(archive.unacknowledged())
        sentence = f"Every journal that is needed can be read; {waiting} trials wait for Slicer."
        yield CheckResult("journals", CheckStatus.OK, sentence)
