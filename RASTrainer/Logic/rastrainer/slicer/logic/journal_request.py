"""Fetch the journal of a trial from the simulator, piece by piece."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from rastrainer.commands import CommandName
from rastrainer.errors import InputError
from rastrainer.protocol import MAX_JOURNAL_BYTES
from rastrainer.slicer.translation import _

End = Callable[[Exception], None]
Ask = Callable[[str, "dict[str, Any]", "Callable[[Mapping[str, Any]], None]", End], None]
"""Sends a command with arguments; the answer's data go to the first function, an error to the
second."""


def fetchJournal(ask: Ask, trialId: str, take: Callable[[bytes], None], end: End) -> None:
    """Fetch a journal, whose truth must be revealed; `take` receives it, `end` a failure."""
    journal = bytearray()

    def add(answer: Mapping[str, Any]) -> None:
        text, following = answer.get("text"), answer.get("next")
        if not isinstance(text, str) or not text.isascii():
            raise InputError(_("The simulator's answer to GetJournal must hold its text."))
        journal.extend(text.encode("ascii"))
        if following is None:
            take(bytes(journal))
            return
        if not text or following != len(journal) or following > MAX_JOURNAL_BYTES:
            raise InputError(_("The pieces of the trial's journal do not follow on each other."))
        ask(CommandName.GET_JOURNAL, {"trialId": trialId, "start": following}, add, end)

    ask(CommandName.GET_JOURNAL, {"trialId": trialId, "start": 0}, add, end)
