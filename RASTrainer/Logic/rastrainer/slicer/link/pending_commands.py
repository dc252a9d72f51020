"""Commands in transit to the simulator, and messages that have arrived from it.

Each command gets exactly one reply, whatever happens; what has arrived is emitted little by little.
"""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from rastrainer.commands import decode_answer_object
from rastrainer.errors import InputError
from rastrainer.igtl.client import Reply
from rastrainer.protocol import DeviceName
from rastrainer.slicer.scene.nodes import (
    capturedPointsNode,
    decodedText,
    labelOf,
    shownText,
    simStateNode,
)
from rastrainer.slicer.signal import ErrorGuard, Signal
from rastrainer.slicer.translation import _

OnReply = Callable[[Reply], None]

MAX_AT_ONCE = 16
"""Most commands without an answer; the simulator carries out as many at once."""
SENDING_S = 0.01
"""Time limit for sending in one turn: sending blocks while the simulator does not read."""


@dataclass(frozen=True)
class Request:
    """A command that is to be sent.

    Attributes:
        name: of the command.
        content: its arguments, JSON.
        timeoutS: how long to wait for its answer after sending it.
    """

    name: str
    content: str
    timeoutS: float
    onReply: OnReply


@dataclass(frozen=True)
class _Sent:
    request: Request
    command: Any
    deadline: float


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
        clock: Callable[[], float] = time.monotonic,
        arrived: Callable[[], None] = lambda: None,
    ) -> None:
        self._guard = guard
        self._clock = clock
        self._arrived = arrived
        self._waiting: deque[Request] = deque()
        self._sendingS = 0.0
        self._sent: list[_Sent] = []
        self._abandoned: list[Any] = []
        self._refused: list[tuple[OnReply, Reply]] = []

    def send(self, request: Request, transmit: Callable[[Request], Any]) -> None:
        """Send a command in its turn; `poll` delivers the reply, never this method.

        `transmit` makes the connector's command of a request, and sends it.
        """
        self._waiting.append(request)
        self._sendSome(transmit)

    def refuse(self, onReply: OnReply, sentence: str) -> None:
        """Have the next `poll` report why a command was not sent."""
        self._refused.append((onReply, Reply(False, sentence)))

    def poll(self, isOpen: bool, transmit: Callable[[Request], Any]) -> None:
        """Deliver replies that have come or will never come; send what is waiting."""
        self._sendingS = 0.0
        replies, self._refused = self._refused, []
        sent, self._sent = self._sent, []
        for item in sent:
            reply = self._replyTo(item, isOpen)
            if reply is None:
                self._sent.append(item)
            else:
                replies.append((item.request.onReply, reply))
                self._abandoned.append(item.command)
        # The connector may still report on an abandoned one: it must live until then.
        self._abandoned = [command for command in self._abandoned if command.IsInProgress()]
        if isOpen:
            self._sendSome(transmit)
        else:
            replies += [(request.onReply, _lost()) for request in self._waiting]
            self._waiting.clear()
        for onReply, reply in replies:
            self._guard.run("The reply to a command", onReply, reply)

    def _sendSome(self, transmit: Callable[[Request], Any]) -> None:
        while self._waiting and len(self._sent) < MAX_AT_ONCE and self._sendingS < SENDING_S:
            begin = self._clock()
            request = self._waiting.popleft()
            command = transmit(request)
            command.AddObserver(command.CommandCompletedEvent, self._noteArrival)
            now = self._clock()
            self._sendingS += now - begin
            self._sent.append(_Sent(request, command, now + request.timeoutS))
        if self._waiting and len(self._sent) < MAX_AT_ONCE:
            self._arrived()

    def _noteArrival(self, _caller: Any, _event: str) -> None:
        self._guard.run("A command's event", self._arrived)

    def _replyTo(self, item: _Sent, isOpen: bool) -> Reply | None:
        command = item.command
        if command.GetCommandStatus() == command.CommandResponseReceived:
            return _answer(command)
        if not isOpen:
            return _lost()
        if not command.IsInProgress() or self._clock() > item.deadline:
            sentence = _("The simulator did not answer {name}.")
            return Reply(False, sentence.format(name=item.request.name))
        return None


def _lost() -> Reply:
    return Reply(False, _("The connection to the simulator was lost."))


def _answer(command: Any) -> Reply:
    if not command.GetSuccessful():
        sentence = shownText(command.GetErrorMessage())
        return Reply(False, sentence or _("The simulator refused without giving a reason."))
    try:
        return Reply(True, "", decode_answer_object(decodedText(command.GetResponseContent())))
    except InputError:
        return Reply(False, _("The simulator's answer cannot be read."))


MAX_KEPT = 256
"""Most commands that may wait. The sender has to repeat further ones, as the simulator does with
trials and answers until they are acknowledged."""
COMMANDS_A_TURN, CHARACTERS_A_TURN = 16, 200_000
"""How much is processed before the application may do something else."""


class Arrivals:
    """Reads what has arrived; what cannot be read is logged and does not stop the rest."""

    def __init__(
        self,
        scene: Any,
        guard: ErrorGuard,
        pointsChanged: Signal,
        stateChanged: Signal,
        commands: Mapping[str, Signal],
    ) -> None:
        """`commands` maps the name of each known command to the signal that emits its content."""
        self._scene = scene
        self._guard = guard
        self._pointsChanged = pointsChanged
        self._stateChanged = stateChanged
        self._signals = commands
        self._commands: deque[tuple[str | bytes, str | bytes]] = deque()
        self._points: tuple = ()
        self._stateText: str | bytes = ""

    def keepCommand(self, name: str | bytes, content: str | bytes) -> None:
        """Keep a command until it can be handled; inside VTK, where nothing may raise.

        It is dropped if too many wait already.
        """
        if len(self._commands) < MAX_KEPT:
            self._commands.append((name, content))

    def emitNodes(self) -> None:
        self._guard.run("The touched points", self._emitPoints)
        self._guard.run("The simulator's state", self._emitState)

    def emitCommands(self) -> None:
        """Emit the stored commands in order; if there are many, the rest follows later."""
        characters = 0
        for _turn in range(min(len(self._commands), COMMANDS_A_TURN)):
            if characters > CHARACTERS_A_TURN:
                break
            name, content = self._commands.popleft()
            characters += len(content)
            name = shownText(name)
            if name in self._signals:
                self._emitContent(content, name, self._signals[name])
            else:
                logging.warning("The simulator sent the unknown command %.40s.", name)

    def _emitPoints(self) -> None:
        node = capturedPointsNode(self._scene)
        points = _snapshot(node)
        if points != self._points:
            self._points = points
            self._guard.emit("The touched points", self._pointsChanged, node)

    def _emitState(self) -> None:
        text = simStateNode(self._scene).GetText()
        if text and text != self._stateText:
            self._stateText = text
            self._emitContent(text, DeviceName.SIM_STATE, self._stateChanged)

    def _emitContent(self, text: str | bytes, name: str, signal: Signal) -> None:
        try:
            value = decode_answer_object(decodedText(text))
        except InputError as error:
            logging.error("What came as %s cannot be read: %s", name, error)
            return
        self._guard.emit(name, signal, value)


def _snapshot(markupsNode: Any) -> tuple:
    return tuple(
        (labelOf(markupsNode, i), tuple(markupsNode.GetNthControlPointPosition(i)))
        for i in range(markupsNode.GetNumberOfControlPoints())
    )
