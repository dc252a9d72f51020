"""Seeds and IDs of trials, drawn from the simulator's seed so that a session can be repeated."""

from __future__ import annotations

import hashlib
import uuid


def trial_seed(seed: int, number: int) -> int:
    """Return the seed of a session's `number`-th trial, 0 … 2^53 − 1 (exact in any JSON reader)."""
    return int.from_bytes(_digest("seed", seed, number)[:8], "big") >> 11


def trial_id(seed: int, number: int) -> str:
    """Return the ID of a session's `number`-th trial, shaped like a random UUID (version 4)."""
    return str(uuid.UUID(bytes=_digest("id", seed, number)[:16], version=4))


def _digest(what: str, seed: int, number: int) -> bytes:
    return hashlib.sha256(f"{what}:{seed}:{number}".encode()).digest()
