"""Commands on their way to the simulator; each gets exactly one reply, whatever happens."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.protocol import decode_json_object
from rastrainer.slicer.translation import _

OnReply = Callable[[Reply], None]


@dataclass(frozen=True)
class _Pending:
    command: Any
    onReply: OnReply
    deadline: float


class PendingCommands:
    """Polls commands for their answers.

    The connector's own time-out is not enough: without a connection it neither sends a command nor
    lets one expire.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._pending: list[_Pending] = []
        self._refused: list[tuple[OnReply, Reply]] = []

    def send(self, connector: Any, command: Any, onReply: OnReply) -> None:
        """Send a command; `onReply` is called by `poll`, never from here."""
        connector.SendCommand(command)
        self._pending.append(_Pending(command, onReply, self._clock() + command.GetTimeoutSec()))

    def refuse(self, onReply: OnReply, sentence: str) -> None:
        """Let the next `poll` say why a command was not sent."""
        self._refused.append((onReply, Reply(False, sentence)))

    def poll(self, isOpen: bool) -> None:
        """Hand over the replies that have come, or that will not come any more."""
        pending, self._pending = self._pending, []
        replies, self._refused = self._refused, []
        for item in pending:
            reply = self._replyTo(item, isOpen)
            if reply is None:
                self._pending.append(item)
            else:
                replies.append((item.onReply, reply))
        for onReply, reply in replies:
            onReply(reply)

    def _replyTo(self, item: _Pending, isOpen: bool) -> Reply | None:
        command = item.command
        if command.GetCommandStatus() == command.CommandResponseReceived:
            return _answer(command)
        if not isOpen:
            return Reply(False, _("The connection to the simulator was lost."))
        if not command.IsInProgress() or self._clock() > item.deadline:
            return Reply(
                False, _("The simulator gave no answer to {name}.").format(name=command.GetName())
            )
        return None


def _answer(command: Any) -> Reply:
    if not command.GetSuccessful():
        return Reply(
            False, command.GetErrorMessage() or _("The simulator refused, without a word.")
        )
    try:
        return Reply(True, "", decode_json_object(command.GetResponseContent()))
    except InputError:
        return Reply(False, _("The simulator's answer cannot be read."))
