"""The instructor's PIN: stored as a slow hash, and with few guesses allowed."""

from __future__ import annotations

import base64
import hashlib
import hmac
import re
import secrets
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.files.writing import write_private_json

PIN_FILE = "instructor.json"
SHORTEST_PIN, LONGEST_PIN = 6, 12
PIN_WORDS = f"{SHORTEST_PIN} to {LONGEST_PIN} digits"
WRONG_GUESSES = 5
FIRST_PAUSE_S = 1.0
LONGEST_PAUSE_S = 300.0
_PIN = re.compile(f"[0-9]{{{SHORTEST_PIN},{LONGEST_PIN}}}")
_MAX_BYTES = 1000
_SALT_BYTES = 16
# 16 MB and about 50 ms for each guess (RFC 7914).
_COST = {"n": 2**14, "r": 8, "p": 1}


class GuessLimit:
    """Lets a secret be guessed five times, and then only after a pause, which doubles each time.

    At five guesses in five minutes, one of a million codes is found in two years.
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._wrong = 0
        self._pause = FIRST_PAUSE_S
        self._open_from = -float("inf")

    def seconds_to_wait(self) -> float:
        return max(0.0, self._open_from - self._clock())

    def guessed(self, is_right: bool) -> bool:
        """Count a guess; return whether it was one too many, so that a pause begins."""
        if is_right:
            self._wrong, self._pause = 0, FIRST_PAUSE_S
            return False
        self._wrong += 1
        if self._wrong < WRONG_GUESSES:
            return False
        self._open_from = self._clock() + self._pause
        self._wrong, self._pause = 0, min(2.0 * self._pause, LONGEST_PAUSE_S)
        return True


@dataclass(frozen=True)
class PinAnswer:
    """The outcome of a guess at a PIN, and how long no other is checked, s."""

    is_right: bool
    wait_s: float


class InstructorPin:
    """The PIN of one seat, in a file of its settings folder.

    Guesses, from boards and at the seat, are checked one after the other, and few of them.
    """

    def __init__(self, config: Path, clock: Callable[[], float] = time.monotonic) -> None:
        """Use the file in a folder, which need not exist; `clock` returns s."""
        self._path = config / PIN_FILE
        self._limit = GuessLimit(clock)
        # Guesses at the same time would be counted too late.
        self._one = threading.Lock()

    @property
    def is_set(self) -> bool:
        return self._path.exists()

    def guess(self, pin: str) -> PinAnswer:
        """Check a guess, unless guessing is paused; takes about 50 ms, in any thread."""
        with self._one:
            wait_s = self._limit.seconds_to_wait()
            if wait_s > 0.0:
                return PinAnswer(False, wait_s)
            values = read_json(self._path, _MAX_BYTES)
            try:
                salt, known = (base64.b64decode(values[name]) for name in ("salt", "hash"))
            except (TypeError, KeyError, ValueError):
                raise InputError(
                    f"{self._path} does not hold an instructor's PIN; set a new one with "
                    "rastrainer instructor-pin."
                ) from None
            is_right = hmac.compare_digest(_hash(pin, salt), known)
            self._limit.guessed(is_right)
            return PinAnswer(is_right, self._limit.seconds_to_wait())

    def set(self, pin: str) -> None:
        """Set a new PIN, or none with ""."""
        if not pin:
            self._path.unlink(missing_ok=True)
            return
        if _PIN.fullmatch(pin) is None:
            raise InputError(f"A PIN has {PIN_WORDS}.")
        salt = secrets.token_bytes(_SALT_BYTES)
        encoded = {"salt": salt, "hash": _hash(pin, salt)}
        values = {name: base64.b64encode(value).decode() for name, value in encoded.items()}
        write_private_json(self._path, values)


def _hash(pin: str, salt: bytes) -> bytes:
    return hashlib.scrypt(pin.encode(errors="replace"), salt=salt, **_COST)
