"""Whether a process runs, and which processes it has started; on Linux."""

from __future__ import annotations

from pathlib import Path


def runs(pid: int) -> bool:
    """Return whether a process runs, and does not only wait for its parent to reap it."""
    fields = _fields(Path("/proc", str(pid)))
    return bool(fields) and fields[0] != "Z"


def started_by(pid: int) -> list[int]:
    """Return the running descendants of a process."""
    found = []
    for place in Path("/proc").glob("[0-9]*"):
        fields = _fields(place)
        if fields and int(fields[1]) == pid and fields[0] != "Z":
            child = int(place.name)
            found += [child, *started_by(child)]
    return found


def _fields(place: Path) -> list[str]:
    """Return what /proc says about a process from its state on; nothing if it has gone."""
    try:
        return (place / "stat").read_text().rpartition(")")[2].split()
    except (FileNotFoundError, ProcessLookupError):
        return []
