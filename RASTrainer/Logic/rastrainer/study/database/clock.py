"""The wall clock of a study's rows."""

from __future__ import annotations

from datetime import datetime, timezone


def utc_now() -> str:
    """Return the current time as ISO 8601 in UTC, to the millisecond."""
    return datetime.now(timezone.utc).isoformat(timespec="milliseconds")


def moment(utc: str) -> datetime:
    """Return the moment of an ISO 8601 text; also before Python 3.11, which knows no Z."""
    return datetime.fromisoformat(utc.replace("Z", "+00:00"))
