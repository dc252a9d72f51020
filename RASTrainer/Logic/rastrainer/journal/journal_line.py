"""One line of a trial's journal: a JSON object that carries its own hash and the one before.

A line is `{"n":…,"previous":"…",…,"sha256":"…"}` and a newline: `n` counts from 1, `previous` is
the `sha256` of the line before (64 zeros in the first), and `sha256` is that of the line's bytes up
to the comma in front of it, closed by `}`.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from typing import Any

from rastrainer.finite_json import DEEPEST, decode_finite_json

FORMAT = "rastrainer-trial-journal"
FORMAT_VERSION = 1
NO_LINE = "0" * 64
"""What the first line carries in place of a hash."""
LONGEST_LINE = 1 << 20
DEEPEST_LINE = DEEPEST + 8
"""Levels of a line: it holds what came in a message, which may be as deep as any."""

FIRST_BYTES = f'{{"n":1,"previous":"{NO_LINE}","kind":"header","format":"{FORMAT}",'.encode()
"""How every journal begins."""

_SEAL = b',"sha256":"'
_SEAL_LENGTH = len(_SEAL) + 64 + len(b'"}')


class DamagedLineError(ValueError):
    """The line is not what was once written; the message says why."""


def encode_line(n: int, previous: str, entry: Mapping[str, Any]) -> tuple[bytes, str]:
    """Return the line of an entry with its newline, and its hash.

    Raises:
        ValueError: the entry holds a number that is not finite.
    """
    body = json.dumps(
        {"n": n, "previous": previous, **entry},
        allow_nan=False,
        check_circular=False,
        separators=(",", ":"),
    ).encode("ascii")
    digest = hashlib.sha256(body).hexdigest()
    return body[:-1] + _SEAL + digest.encode("ascii") + b'"}\n', digest


def decode_line(line: bytes, n: int, previous: str) -> dict[str, Any]:
    """Return the entry of a line, without its newline, that shall be the `n`-th after `previous`.

    The entry has `sha256` as its last key.

    Raises:
        DamagedLineError: something in it has been altered, or it is not the line that belongs here.
    """
    body, seal = line[:-_SEAL_LENGTH] + b"}", line[-_SEAL_LENGTH:]
    digest = hashlib.sha256(body).hexdigest()
    if seal != _SEAL + digest.encode("ascii") + b'"}':
        raise DamagedLineError("its bytes do not match its hash")
    try:
        entry = decode_finite_json(line.decode("ascii"), DEEPEST_LINE)
    except ValueError:
        raise DamagedLineError("it is not JSON") from None
    if not isinstance(entry, dict) or not isinstance(entry.get("kind"), str):
        raise DamagedLineError("it is not an entry of a journal")
    if entry.get("n") != n:
        raise DamagedLineError(f"it has the number {json.dumps(entry.get('n'))[:20]}")
    if entry.get("previous") != previous:
        raise DamagedLineError("it does not follow the line before")
    return entry
