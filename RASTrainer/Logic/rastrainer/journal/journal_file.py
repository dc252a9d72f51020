"""A trial's journal: stamped and hashed lines, and whether a file is intact, cut short or altered.

A line is a JSON object with its own hash and the previous line's:
`{"n":…,"previous":"…",…,"sha256":"…"}` and a newline. `n` counts from 1, `previous` is the `sha256`
of the previous line (64 zeros in the first), and `sha256` is the hash of the line's bytes
before its comma, closed by `}`. An entry and its times stand between them; see `entries`.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import Any, BinaryIO

from rastrainer.errors import InputError
from rastrainer.journal.entries import FORMAT, FORMAT_VERSION, JournalHeader, Line, read_line
from rastrainer.json_checks import MAX_DEPTH, decode_finite_json

LINES_PER_PAUSE = 10
"""They take about 0.3 ms."""
NO_LINE = "0" * 64
"""Hash before the first line."""
MAX_LINE_BYTES = 1 << 20
MAX_LINE_DEPTH = MAX_DEPTH + 8
"""A line may contain a message of the maximum depth."""

SEED_SUFFIX = ".seed"
"""Ends the name of the file that holds the seed of the head's pose while a trial is open."""

FIRST_BYTES = f'{{"n":1,"previous":"{NO_LINE}","kind":"header","format":"{FORMAT}",'.encode()
"""The start of every journal."""

_SEAL = b',"sha256":"'
_SEAL_LENGTH = len(_SEAL) + 64 + len(b'"}')


def file_stamp(utc: str) -> str:
    """Return an ISO 8601 moment as it goes into a file name, such as `20240517T093000Z`."""
    return utc.replace("-", "").replace(":", "").split(".")[0] + "Z"


class DamagedLineError(ValueError):
    """The line was altered; the message says how."""


def encode_line(n: int, previous: str, entry: Mapping[str, Any]) -> tuple[bytes, str]:
    """Return the line of an entry with its newline, and its hash.

    Raise ValueError if the entry has a number that is not finite.
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
    """Return the entry of a line without newline, which must be the `n`-th after `previous`.

    The entry has `sha256` as its last key. Raise `DamagedLineError` for another or an altered line.
    """
    body, seal = line[:-_SEAL_LENGTH] + b"}", line[-_SEAL_LENGTH:]
    digest = hashlib.sha256(body).hexdigest()
    if seal != _SEAL + digest.encode("ascii") + b'"}':
        raise DamagedLineError("its bytes do not match its hash")
    try:
        entry = decode_finite_json(line.decode("ascii"), MAX_LINE_DEPTH)
    except ValueError:
        raise DamagedLineError("it is not JSON") from None
    if not isinstance(entry, dict) or not isinstance(entry.get("kind"), str):
        raise DamagedLineError("it is not an entry of a journal")
    if entry.get("n") != n:
        raise DamagedLineError(f"it has the number {json.dumps(entry.get('n'))[:20]}")
    if entry.get("previous") != previous:
        raise DamagedLineError("it does not follow the line before")
    return entry


ENDS = frozenset({"registered", "aborted", "stopped", "drill"})
"""Kinds of entries that complete a trial, or a drill of decisions."""
_STEPS = frozenset({"header", "phase", "continued", *ENDS})


class Integrity(str, Enum):
    """The state of a journal."""

    INTACT = "intact"
    CUT_SHORT = "cut short"
    ALTERED = "altered"


@dataclass(frozen=True)
class JournalReading:
    """The content of a journal, and its integrity in words.

    The entries are JSON objects of the complete lines, up to the first altered one; these have
    `end` bytes. The seed of the head's pose is as secret as the pose while the trial is open: its
    last entry reveals it; until then a separate file holds it (`SEED_SUFFIX`).
    """

    path: Path
    integrity: Integrity
    entries: tuple[dict[str, Any], ...]
    end: int
    sentence: str
    seed: int | None = None

    def lines(self, pause: Callable[[], None] = lambda: None) -> Iterator[Line]:
        """Yield the entries with their times, the header with the seed.

        `pause` is called regularly; it may block, to let other threads run.
        """
        for index, entry in enumerate(self.entries):
            if index % LINES_PER_PAUSE == 0:
                pause()
            yield read_line(entry if index else {**entry, "seed": self.seed})

    @property
    def header(self) -> JournalHeader:
        header = next(self.lines(), None)
        if header is None or not isinstance(header.entry, JournalHeader):
            raise InputError(f"{self.path} has no complete line.")
        return header.entry

    def of_kind(self, *kinds: str) -> list[dict[str, Any]]:
        return [entry for entry in self.entries if entry["kind"] in kinds]


def read_journal(path: Path, pause: Callable[[], None] = lambda: None) -> JournalReading:
    """Read a journal as far as it is intact.

    `pause` is called regularly while reading; it may block, to let other threads run.
    """
    try:
        with path.open("rb") as file:
            reading = _read(path, file, pause)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from None
    seed = next((entry["seed"] for entry in reversed(reading.entries) if "seed" in entry), None)
    if seed is None:
        with contextlib.suppress(OSError, ValueError):
            seed = int(path.with_suffix(SEED_SUFFIX).read_text("ascii"))
    return replace(reading, seed=seed)


def _read(path: Path, file: BinaryIO, pause: Callable[[], None]) -> JournalReading:
    beginning = file.read(len(FIRST_BYTES))
    if not FIRST_BYTES.startswith(beginning):
        start = FIRST_BYTES.decode()[:-1].replace(NO_LINE, "000…")
        raise InputError(f"{path} is not a trial's journal: it should start with {start}.")
    file.seek(0)
    entries: list[dict[str, Any]] = []
    previous, end = NO_LINE, 0
    while line := file.readline(MAX_LINE_BYTES):
        n = len(entries) + 1
        if n % LINES_PER_PAUSE == 0:
            pause()
        if not line.endswith(b"\n") and len(line) < MAX_LINE_BYTES:
            break
        try:
            entry = decode_line(line[:-1], n, previous)
        except DamagedLineError as error:
            sentence = f"altered: line {n} is not as it was written, {error}"
            return JournalReading(path, Integrity.ALTERED, tuple(entries), end, sentence)
        if n == 1 and entry.get("version") != FORMAT_VERSION:
            raise InputError(
                f"{path} has the format version {entry.get('version')!r}; "
                f"this program reads version {FORMAT_VERSION}."
            )
        entries.append(entry)
        previous, end = entry["sha256"], end + len(line)
    steps = [entry["kind"] for entry in entries if entry["kind"] in _STEPS]
    if line:
        why = "the line after it is incomplete"
    elif not steps or steps[-1] not in ENDS:
        why = "the trial was not ended"
    else:
        sentence = f"intact: {len(entries)} lines"
        return JournalReading(path, Integrity.INTACT, tuple(entries), end, sentence)
    sentence = f"cut short: recovered up to line {len(entries)}, {why}"
    return JournalReading(path, Integrity.CUT_SHORT, tuple(entries), end, sentence)
