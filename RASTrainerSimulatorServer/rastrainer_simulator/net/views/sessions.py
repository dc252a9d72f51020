"""The keys of paired views, and what each key lets its view do."""

from __future__ import annotations

import hashlib
import hmac
import secrets
from collections import deque
from collections.abc import Mapping
from enum import Enum

KEY_BYTES = 32
SHORTEST_KEY = 32
LONGEST_KEY = 200


class ViewRole(str, Enum):
    """What somebody was paired for."""

    VIEW = "view"
    """To see and to drive."""
    SPECTATOR = "spectator"
    """To see everything and to drive nothing."""


class Sessions:
    """The keys that were given out, by their hashes."""

    def __init__(self, most: Mapping[ViewRole, int]) -> None:
        """Remember so many keys of each role; then the oldest of that role is forgotten."""
        self._hashes = {role: deque[bytes](maxlen=most[role]) for role in ViewRole}

    def open(self, role: ViewRole = ViewRole.VIEW) -> str:
        """Return a new key."""
        key = secrets.token_urlsafe(KEY_BYTES)
        self._hashes[role].append(_hash(key))
        return key

    def admit(self, key: str) -> None:
        """Accept a view's key that was agreed on before the simulator was started."""
        self._hashes[ViewRole.VIEW].append(_hash(key))

    def role(self, key: str) -> ViewRole | None:
        """Return what a key was given out for, None for no key; it takes the same time for all."""
        if not SHORTEST_KEY <= len(key) <= LONGEST_KEY:
            return None
        wanted = _hash(key)
        found = None
        for role, hashes in self._hashes.items():
            matches = [hmac.compare_digest(wanted, known) for known in hashes]
            if any(matches):
                found = role
        return found


def _hash(key: str) -> bytes:
    return hashlib.sha256(key.encode(errors="replace")).digest()
