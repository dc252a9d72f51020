"""Commands of clients: checked, submitted to the simulation in turn, then answered."""

from __future__ import annotations

import asyncio
import json
from collections import deque
from collections.abc import Callable, Mapping
from concurrent.futures import Future
from dataclasses import dataclass, field
from functools import partial
from typing import Any

from rastrainer.command_arguments import check_arguments, decode_json_object
from rastrainer.errors import InputError
from rastrainer.igtl.content import ERROR_KEY, FAIL, STATUS_KEY, SUCCESS, Command, CommandReply
from rastrainer.igtl.message import Message
from rastrainer.protocol import DeviceName
from rastrainer_simulator.net.igtl.connection import ClientConnection
from rastrainer_simulator.net.igtl.outgoing import Outgoing
from rastrainer_simulator.net.limits import LinkLimits
from rastrainer_simulator.state import Answer

Submit = Callable[[ClientConnection, str, Mapping[str, Any]], "Future[Answer]"]


@dataclass
class _Turn:
    """One client's commands: how many the simulation has, and which wait."""

    at_work: int = 0
    waiting: deque[tuple[Command, Mapping[str, Any]]] = field(default_factory=deque)
    waiting_bytes: int = 0


class CommandHandler:
    """Answers every COMMAND with an RTS_COMMAND, and never waits for one itself.

    A client's commands are carried out in order. Only a few of them are submitted at a time, so
    that no client can crowd the others out of a tick.
    """

    def __init__(self, submit: Submit, limits: LinkLimits):
        """`submit` takes checked arguments and returns the answer's future immediately."""
        self._submit = submit
        self._limits = limits
        self._loop = asyncio.get_running_loop()
        self._turns: dict[ClientConnection, _Turn] = {}

    def handle(self, connection: ClientConnection, command: Command) -> None:
        """Check a command and carry it out in its turn."""
        try:
            arguments = check_arguments(command.name, decode_json_object(command.body))
        except InputError as error:
            self._refuse(connection, command, str(error))
            return
        turn = self._turns.setdefault(connection, _Turn())
        is_full = len(turn.waiting) >= self._limits.waiting_commands
        if is_full or turn.waiting_bytes > self._limits.waiting_command_bytes:
            self._refuse(connection, command, "Too many commands wait: wait for their answers.")
            return
        turn.waiting.append((command, arguments))
        turn.waiting_bytes += len(command.body)
        self._submit_waiting(connection, turn)

    def forget(self, connection: ClientConnection) -> None:
        """Drop the waiting commands of a client that has left."""
        self._turns.pop(connection, None)

    def _submit_waiting(self, connection: ClientConnection, turn: _Turn) -> None:
        while turn.waiting and turn.at_work < self._limits.commands_at_once:
            command, arguments = turn.waiting.popleft()
            turn.waiting_bytes -= len(command.body)
            turn.at_work += 1
            answered = partial(self._answered, connection, command)
            future = self._submit(connection, command.name, arguments)
            future.add_done_callback(partial(self._loop.call_soon_threadsafe, answered))

    def _answered(
        self, connection: ClientConnection, command: Command, done: Future[Answer]
    ) -> None:
        turn = self._turns.get(connection)
        if turn is None:
            return
        turn.at_work -= 1
        if done.cancelled() or done.exception() is not None:
            self._refuse(connection, command, "The simulator could not carry the command out.")
        else:
            answer = done.result()
            self._reply(connection, command, answer.ok, answer.message, answer.data)
        self._submit_waiting(connection, turn)

    def _refuse(self, connection: ClientConnection, command: Command, sentence: str) -> None:
        self._reply(connection, command, False, sentence, {})

    def _reply(
        self,
        connection: ClientConnection,
        command: Command,
        is_success: bool,
        sentence: str,
        data: Mapping[str, Any],
    ) -> None:
        """Send an answer; its body repeats the sentence for clients that read no metadata."""
        metadata = {STATUS_KEY: SUCCESS if is_success else FAIL}
        if not is_success:
            metadata[ERROR_KEY] = sentence
            data = {**data, "error": sentence}
        name = command.name if command.name.isascii() and command.name.isprintable() else ""
        body = json.dumps(dict(data), allow_nan=False)
        reply = CommandReply(command.command_id, name, body)
        connection.send(Outgoing(Message(DeviceName.COMMAND, reply, metadata)))
