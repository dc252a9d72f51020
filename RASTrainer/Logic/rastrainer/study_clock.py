"""The wall clock of a study's rows."""

from __future__ import annotations

from datetime import datetime, timezone


def utc_now() -> str:
    """Return the current time as ISO 8601 in UTC, to the millisecond."""
    return datetime.now(timezone.utc).isoformat(timespec="milliseconds")
