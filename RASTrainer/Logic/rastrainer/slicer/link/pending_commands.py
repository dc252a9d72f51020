"""Commands in transit to the simulator: each gets exactly one reply in any case."""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from rastrainer.commands import decode_answer_object
from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.slicer.scene.nodes import decodedText, shownText
from rastrainer.slicer.signal import ErrorGuard
from rastrainer.slicer.translation import _

OnReply = Callable[[Reply], None]

MAX_AT_ONCE = 16
"""Most commands without an answer; the simulator carries out as many at once."""
_LOST = Reply(False, _("The connection to the simulator was lost."))


@dataclass
class Request:
    """A command that is to be sent: `content` is JSON; the last two are set once it is sent."""

    name: str
    content: str
    timeoutS: float
    onReply: OnReply
    command: Any = None
    deadline: float = 0.0


class PendingCommands:
    """Sends commands a few at a time, and delivers their answers.

    An answer is noted at the connector's event, from which `arrived` is called, inside VTK: it must
    do no more than see to it that `poll` is called soon, in another turn. The regular `poll` finds
    what no event has reported. The connector's own time-out is not enough: without a connection it
    neither sends a command nor lets one expire.
    """

    def __init__(
        self,
        guard: ErrorGuard,
        transmit: Callable[[Request], Any],
        clock: Callable[[], float] = time.monotonic,
        arrived: Callable[[], None] = lambda: None,
    ) -> None:
        """`transmit` sends a request, and returns the connector's command."""
        self._guard = guard
        self._transmit = transmit
        self._clock = clock
        self._arrived = arrived
        self._waiting: deque[Request] = deque()
        self._sent: list[Request] = []
        self._abandoned: list[Any] = []
        self._refused: list[tuple[OnReply, Reply]] = []

    def send(self, request: Request) -> None:
        """Send a command in its turn; `poll` delivers the reply, never this method."""
        self._waiting.append(request)
        self._sendSome()

    def refuse(self, onReply: OnReply, sentence: str) -> None:
        self._refused.append((onReply, Reply(False, sentence)))

    def poll(self, isOpen: bool) -> None:
        """Deliver replies that have come or will never come; send waiting commands."""
        replies, self._refused = self._refused, []
        sent, self._sent = self._sent, []
        for request in sent:
            reply = self._replyTo(request, isOpen)
            if reply is None:
                self._sent.append(request)
            else:
                replies.append((request.onReply, reply))
                self._abandoned.append(request.command)
        # The connector may still report on an abandoned one: it must live until then.
        self._abandoned = [command for command in self._abandoned if command.IsInProgress()]
        if isOpen:
            self._sendSome()
        else:
            replies += [(request.onReply, _LOST) for request in self._waiting]
            self._waiting.clear()
        for onReply, reply in replies:
            self._guard.run("The reply to a command", onReply, reply)

    def _sendSome(self) -> None:
        while self._waiting and len(self._sent) < MAX_AT_ONCE:
            request = self._waiting.popleft()
            request.command = self._transmit(request)
            request.command.AddObserver(
                request.command.CommandCompletedEvent,
                lambda *_event: self._guard.run("A command's event", self._arrived),
            )
            request.deadline = self._clock() + request.timeoutS
            self._sent.append(request)

    def _replyTo(self, request: Request, isOpen: bool) -> Reply | None:
        command = request.command
        if command.GetCommandStatus() == command.CommandResponseReceived:
            if not command.GetSuccessful():
                sentence = shownText(command.GetErrorMessage())
                return Reply(False, sentence or _("The simulator refused without giving a reason."))
            try:
                return Reply(
                    True, "", decode_answer_object(decodedText(command.GetResponseContent()))
                )
            except InputError:
                return Reply(False, _("The simulator's answer cannot be read."))
        if not isOpen:
            return _LOST
        if not command.IsInProgress() or self._clock() > request.deadline:
            sentence = _("The simulator did not answer {name}.")
            return Reply(False, sentence.format(name=request.name))
        return None
