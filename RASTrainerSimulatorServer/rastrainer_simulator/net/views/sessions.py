"""The keys of paired views, and what each key lets its view do."""

from __future__ import annotations

import hashlib
import hmac
import secrets
from collections import deque
from collections.abc import Mapping
from enum import Enum
from pathlib import Path

from rastrainer.errors import InputError
from rastrainer.files.reading import read_json
from rastrainer.files.writing import write_private_json

KEY_BYTES = 32
SHORTEST_KEY = 32
LONGEST_KEY = 200
BOARDS_FILE = "boards.json"
_MAX_BYTES = 100_000
_HASH_DIGITS = 64


class ViewRole(str, Enum):
    """What somebody was paired for."""

    VIEW = "view"
    """To see and to drive."""
    SPECTATOR = "spectator"
    """To see everything and to drive nothing."""
    BOARD = "board"
    """As a spectator, from a teacher's board; its key outlives the simulator's process."""

    @property
    def only_watches(self) -> bool:
        """Whether its views may drive nothing."""
        return self is not ViewRole.VIEW


class Sessions:
    """The keys that were given out, by their hashes."""

    def __init__(self, most: Mapping[ViewRole, int], boards: Path | None = None) -> None:
        """Remember so many keys of each role; then the oldest of that role is forgotten.

        The keys of boards are also in the file `boards`; deleting it unpairs all boards.

        Raises:
            InputError: the file cannot be read.
        """
        self._hashes = {role: deque[bytes](maxlen=most[role]) for role in ViewRole}
        self._boards = boards
        if boards is not None and boards.exists():
            self._hashes[ViewRole.BOARD].extend(_read(boards))

    def open(self, role: ViewRole = ViewRole.VIEW) -> str:
        """Return a new key.

        Raises:
            InputError: a board's key cannot be kept.
        """
        key = secrets.token_urlsafe(KEY_BYTES)
        self._hashes[role].append(_hash(key))
        if role is ViewRole.BOARD and self._boards is not None:
            _write(self._boards, self._hashes[role])
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


def _read(path: Path) -> list[bytes]:
    found = read_json(path, _MAX_BYTES)
    try:
        if any(len(each) != _HASH_DIGITS for each in found):
            raise ValueError
        return [bytes.fromhex(each) for each in found]
    except (TypeError, ValueError):
        raise InputError(
            f"{path} does not hold the hashes of boards' keys; delete it, and pair boards again."
        ) from None


def _write(path: Path, hashes: deque[bytes]) -> None:
    write_private_json(path, [each.hex() for each in hashes])
