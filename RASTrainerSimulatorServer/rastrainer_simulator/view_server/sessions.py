"""Who may look: the keys that were given out, remembered only as hashes."""

from __future__ import annotations

import hashlib
import hmac
import secrets
from collections import deque

KEY_BYTES = 32
SHORTEST_KEY = 32
LONGEST_KEY = 200


class Sessions:
    """The keys of paired views."""

    def __init__(self, most: int) -> None:
        """Remember up to `most` keys; then the oldest is forgotten."""
        self._hashes: deque[bytes] = deque(maxlen=most)

    def open(self) -> str:
        """Return a new key."""
        key = secrets.token_urlsafe(KEY_BYTES)
        self._hashes.append(_hash(key))
        return key

    def admit(self, key: str) -> None:
        """Accept a key that was agreed on before the simulator was started."""
        self._hashes.append(_hash(key))

    def knows(self, key: str) -> bool:
        """Return whether a key was given out; it takes the same time for every one."""
        if not SHORTEST_KEY <= len(key) <= LONGEST_KEY:
            return False
        wanted = _hash(key)
        matches = [hmac.compare_digest(wanted, known) for known in self._hashes]
        return any(matches)


def _hash(key: str) -> bytes:
    return hashlib.sha256(key.encode(errors="replace")).digest()
