"""Whether the ports are free, and who holds them where they are not."""

from __future__ import annotations

import contextlib
import socket
from collections.abc import Iterator
from pathlib import Path

from rastrainer.protocol import DEFAULT_HOST
from rastrainer_simulator.doctor.finding import Finding, Verdict
from rastrainer_simulator.listener import listening_socket

_LISTENS = "0A"


def check_ports(link: int, views: int) -> Iterator[Finding]:
    """Try the port of OpenIGTLink, and the one that views are served on."""
    yield _link(link)
    yield _views(views)


def _link(port: int) -> Finding:
    reason = _refusal(port)
    if reason is None:
        return Finding("ports", Verdict.OK, f"Port {port} for OpenIGTLink is free.")
    return Finding(
        "ports",
        Verdict.PROBLEM,
        f"Port {port} for OpenIGTLink cannot be used: {reason}.",
        "End that program, or choose another port: rastrainer simulator --port NUMBER, and the "
        "same in Slicer.",
    )


def _views(port: int) -> Finding:
    reason = _refusal(port)
    if reason is None:
        return Finding("ports", Verdict.OK, f"Port {port} for the views is free.")
    return Finding(
        "ports",
        Verdict.WARNING,
        f"Port {port} for the views cannot be used: {reason}.",
        "The simulator takes another one and says which; end that program to have this one.",
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
    """Return the program that listens on a port, "" where that is not known (Linux tells)."""
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
