"""When something was recorded: simulated time, the monotonic clock and UTC, side by side."""

from __future__ import annotations

import time
from datetime import datetime, timezone
from typing import Any


def stamp(tick: int, sim_time: float) -> dict[str, Any]:
    """Return the times that every entry of a journal carries, in s and as ISO 8601."""
    return {
        "tick": tick,
        "simTime": sim_time,
        "monotonic": time.monotonic(),
        "utc": iso(datetime.now(timezone.utc)),
    }


def iso(moment: datetime) -> str:
    """Return a moment in UTC as ISO 8601, such as `2024-05-17T09:30:00.250Z`."""
    return moment.isoformat(timespec="milliseconds").replace("+00:00", "Z")


def file_stamp(utc: str) -> str:
    """Return an ISO 8601 moment as it goes into a file name, such as `20240517T093000Z`."""
    return utc.replace("-", "").replace(":", "").split(".")[0] + "Z"
