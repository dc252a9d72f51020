"""Limits on clients, views and trials that a site may change, and their file."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated

from rastrainer.files.reading import read_json
from rastrainer.json_records import record_from_json
from rastrainer_simulator.loop.timing import TrialLimits, above_zero

LIMITS_FILE = "limits.json"
MAX_BYTES = 2**14
Seconds = Annotated[float, above_zero(86_400)]
Count = Annotated[int, above_zero(2**16, is_whole=True)]


@dataclass(frozen=True)
class LinkLimits:
    """Limits of the OpenIGTLink server.

    Another connection replaces the oldest that has never sent a message, if any; a client that does
    not read is dropped after `slow_client_s`.
    """

    clients: Count = 128
    slow_client_s: Seconds = 5.0


@dataclass(frozen=True)
class ViewLimits:
    """Limits of the view server: streams at a time, and times without a message from a view.

    After `silent_s` its held inputs are released, after `lost_s` it counts as not seen if it
    reported its frames every second, after `gone_s` it counts as gone.
    """

    views: Count = 32
    silent_s: Seconds = 0.5
    lost_s: Seconds = 5.0
    gone_s: Seconds = 30.0


@dataclass(frozen=True)
class ServerLimits:
    """What everyone at the server's ports may cost."""

    clients: LinkLimits = field(default_factory=LinkLimits)
    views: ViewLimits = field(default_factory=ViewLimits)
    trials: TrialLimits = field(default_factory=TrialLimits)


def read_limits(folder: Path) -> ServerLimits:
    """Return the limits that the file in a folder sets, with defaults for missing limits."""
    path = folder / LIMITS_FILE
    if not path.exists():
        return ServerLimits()
    return record_from_json(ServerLimits, read_json(path, MAX_BYTES), str(path), only_known=True)
