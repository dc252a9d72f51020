"""Read a trial's journal back and say whether it is intact, cut short or altered."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from typing import Any, BinaryIO

from rastrainer.errors import InputError
from rastrainer.journal.journal_line import (
    FIRST_BYTES,
    FORMAT_VERSION,
    LONGEST_LINE,
    NO_LINE,
    DamagedLineError,
    decode_line,
)

ENDS = frozenset({"registered", "aborted", "stopped"})
"""Kinds of entries after which nothing of the trial itself is missing."""
_STEPS = frozenset({"header", "phase", "continued", *ENDS})


class Integrity(str, Enum):
    """What became of a journal."""

    INTACT = "intact"
    CUT_SHORT = "cut short"
    ALTERED = "altered"


@dataclass(frozen=True)
class JournalReading:
    """What a journal says.

    Attributes:
        path: of the file.
        integrity: whether all of it is there, as it was written.
        entries: of the whole lines, up to the first that was altered.
        end: how many bytes these lines take.
        sentence: the same in words.
    """

    path: Path
    integrity: Integrity
    entries: tuple[dict[str, Any], ...]
    end: int
    sentence: str

    @property
    def header(self) -> dict[str, Any]:
        """The first entry.

        Raises:
            InputError: not even the first line is whole.
        """
        if not self.entries:
            raise InputError(f"{self.path} holds no whole line.")
        return self.entries[0]

    @property
    def last_hash(self) -> str:
        """The hash that the next line would have to carry."""
        return self.entries[-1]["sha256"] if self.entries else NO_LINE

    def of_kind(self, *kinds: str) -> list[dict[str, Any]]:
        """Return the entries of the given kinds, in their order."""
        return [entry for entry in self.entries if entry["kind"] in kinds]


def read_journal(path: Path) -> JournalReading:
    """Read a journal as far as it is whole.

    Raises:
        InputError: the file cannot be read, is no journal, or is of another format version.
    """
    try:
        with path.open("rb") as file:
            return _read(path, file)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}.") from None


def _read(path: Path, file: BinaryIO) -> JournalReading:
    beginning = file.read(len(FIRST_BYTES))
    if not FIRST_BYTES.startswith(beginning):
        raise InputError(f"{path} is not a trial's journal: it should begin with {_BEGINNING}.")
    file.seek(0)
    entries: list[dict[str, Any]] = []
    previous, end = NO_LINE, 0
    while line := file.readline(LONGEST_LINE):
        n = len(entries) + 1
        if not line.endswith(b"\n") and len(line) < LONGEST_LINE:
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
    return JournalReading(path, *_judged(entries, end, whole=not line))


def _judged(
    entries: list[dict[str, Any]], end: int, whole: bool
) -> tuple[Integrity, tuple[dict[str, Any], ...], int, str]:
    steps = [entry["kind"] for entry in entries if entry["kind"] in _STEPS]
    ended = bool(steps) and steps[-1] in ENDS
    if whole and ended:
        return Integrity.INTACT, tuple(entries), end, f"intact: {len(entries)} lines"
    why = "the trial was not ended" if whole else "the line after it is not whole"
    sentence = f"cut short: recovered up to line {len(entries)}, {why}"
    return Integrity.CUT_SHORT, tuple(entries), end, sentence


_BEGINNING = '{"n":1,"previous":"000…","kind":"header","format":"rastrainer-trial-journal"'
