"""Which tasks of which head each trainee has done, by the journals and this session's trials."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from rastrainer.journal.journal_file import (
    MAX_LINE_BYTES,
    NO_LINE,
    DamagedLineError,
    decode_line,
)
from rastrainer.protocol import TRIAL_RUN, AbortReason, Phase

_TAIL_BYTES = 1 << 17
_REGISTERED = b'"kind":"registered"'
_PRACTICED = (
    f'"phase":"{Phase.COMPLETE.value}"'.encode(),
    f'"reason":"{AbortReason.PRACTICE_OVER.value}"'.encode(),
)


class DoneTasks:
    """Counts a task as done when it was registered.

    The trial run also counts when all its points were touched, or when it was ended after its time
    was over, as the paper's procedure has it (figure 4).

    Attributes:
        journals: of each trainee, oldest first; only those that were there at the beginning.
    """

    def __init__(self, records: Path) -> None:
        """Look through the folder's journals: at the first line and the end of each."""
        self.journals: dict[str, list[Path]] = defaultdict(list)
        self._done: dict[tuple[str, str], set[str]] = defaultdict(set)
        for path in sorted(records.glob("*.journal")):
            self._take(path)

    def note(self, trainee: str, scenario: str, task: str) -> None:
        """Take note of a scenario's task that was done."""
        self._done[trainee, scenario].add(task)

    def has_done(self, trainee: str, scenario: str, task: str) -> bool:
        """Return whether a trainee has done a scenario's task."""
        return task in self._done.get((trainee, scenario), ())

    def latest_trainees(self, count: int) -> tuple[str, ...]:
        """Return so many trainees at most, who trained last first."""
        known = (trainee for trainee, journals in self.journals.items() if journals)
        latest = sorted(known, key=lambda trainee: self.journals[trainee][-1].name, reverse=True)
        return tuple(latest[:count])

    def missing_before(
        self, trainee: str, scenario: str, task: str, order: Sequence[str]
    ) -> str | None:
        """Return the first task that has to be done before another; None where none is missing."""
        done = self._done.get((trainee, scenario), ())
        return next((name for name in order[: order.index(task)] if name not in done), None)

    def _take(self, path: Path) -> None:
        """Take note of a journal; one that cannot be read counts for nothing."""
        try:
            with path.open("rb") as file:
                header = decode_line(file.readline(MAX_LINE_BYTES).rstrip(b"\n"), 1, NO_LINE)
                file.seek(max(0, path.stat().st_size - _TAIL_BYTES))
                tail = file.read(_TAIL_BYTES)
            what = header["trainee"], header["scenario"]["name"], header["task"]
        except (OSError, KeyError, TypeError, DamagedLineError):
            return
        if not all(isinstance(word, str) for word in what):
            return
        self.journals[what[0]].append(path)
        is_practiced = header["task"] == TRIAL_RUN and any(mark in tail for mark in _PRACTICED)
        if _REGISTERED in tail or is_practiced:
            self.note(*what)
