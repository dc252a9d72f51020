"""The pairing code, which a person types into a view, and the session keys given out for it."""

from __future__ import annotations

import hashlib
import hmac
import logging
import secrets
from collections import deque
from collections.abc import Callable

_log = logging.getLogger(__name__)

DIGITS = 6
WRONG_CODES = 5
FIRST_PAUSE_S = 1.0
LONGEST_PAUSE_S = 300.0
WRONG = "This is not the pairing code that the simulator shows."
TOO_MANY = "There were too many wrong codes: wait, then use the new code that the simulator shows."
KEY_BYTES = 32
SHORTEST_KEY = 32
LONGEST_KEY = 200


class PairingCode:
    """The present code. After five wrong ones there is a new one, and a pause that grows.

    So nobody gets far by guessing: at five guesses in five minutes, one in two years is right.
    """

    def __init__(self, clock: Callable[[], float], on_new: Callable[[str], None]) -> None:
        """Make a code; `on_new` is given each one after it, to be shown."""
        self._clock = clock
        self._on_new = on_new
        self._wrong = 0
        self._pause = FIRST_PAUSE_S
        self._open_from = -float("inf")
        self.code = _new_code()
        """What a person types; never logged."""

    def seconds_to_wait(self) -> float:
        """Return how long no code is looked at; 0 where one may be tried."""
        return max(0.0, self._open_from - self._clock())

    def accepts(self, code: str) -> bool:
        """Compare a code, in the same time for every one, and count the wrong ones."""
        if hmac.compare_digest(code.encode(), self.code.encode()):
            self._wrong, self._pause = 0, FIRST_PAUSE_S
            return True
        self._wrong += 1
        if self._wrong >= WRONG_CODES:
            self._renew()
        return False

    def _renew(self) -> None:
        _log.warning("%d wrong pairing codes were tried; there is a new one.", self._wrong)
        self._open_from = self._clock() + self._pause
        self._wrong, self._pause = 0, min(2.0 * self._pause, LONGEST_PAUSE_S)
        self.code = _new_code()
        self._on_new(self.code)


def _new_code() -> str:
    return f"{secrets.randbelow(10**DIGITS):0{DIGITS}d}"


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
