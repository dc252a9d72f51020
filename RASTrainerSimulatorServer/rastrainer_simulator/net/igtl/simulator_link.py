"""The simulator on the link: what each message of a client leads to, and the server's heartbeat.

Commands are checked, submitted to the simulation in turn, then answered.
"""

from __future__ import annotations

import asyncio
import contextlib
import itertools
import json
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import rastrainer
from rastrainer.commands import COMMANDS, CommandName, check_arguments, decode_json_object
from rastrainer.decision.drill_record import DrillRecord
from rastrainer.errors import InputError
from rastrainer.igtl.content import (
    ERROR_KEY,
    FAIL,
    STATUS_KEY,
    SUCCESS,
    Command,
    CommandReply,
    Status,
    Transform,
)
from rastrainer.igtl.message import Message
from rastrainer.json_records import record_to_json
from rastrainer.protocol import PROTOCOL_VERSION, DeviceName, Rate
from rastrainer.scenario.scenario import Scenario
from rastrainer.study.protocol.steps import StepAnswers
from rastrainer.trial.record import AbortedTrial
from rastrainer_simulator.net.igtl.outgoing import Outgoing
from rastrainer_simulator.net.igtl.publisher import PoseSubscription, Publisher, told
from rastrainer_simulator.net.igtl.registration_check import CHECKED, SubmitCommand, submit_checked
from rastrainer_simulator.net.igtl.server import ClientConnection, IgtlServer
from rastrainer_simulator.net.limits import LinkLimits
from rastrainer_simulator.record.trial_archive import DeliveredRecord
from rastrainer_simulator.state import Answer, SimulationState, answered
from rastrainer_simulator.texts.texts import LocalizedText

Submit = Callable[[ClientConnection, str, Mapping[str, Any]], "Future[Answer]"]
_OWN_DEVICES = frozenset(
    {DeviceName.TOOL_TIP_TO_WORLD, DeviceName.INSTRUMENT_TIP_TO_WORLD, *DeviceName.LINK_TO_WORLD}
)
COMMANDS_AT_ONCE = 16
"""Commands of one client that are submitted to the control loop at a time."""
WAITING_COMMANDS, WAITING_COMMAND_BYTES = 4096, 2**20
"""Further commands that may wait for their turn; another is refused."""
COMMANDS_OF_ALL = 1024
"""Commands of all clients that are submitted at a time, also of those that have left; another is
refused. Else a peer that comes again and again could fill the memory."""
TOO_MANY = "Too many commands wait: wait for their answers."
OFFERS_AT_ONCE = 8
"""Trials in one round of offers."""
_NUMBERS = 2**32


class ClientCommands:
    """Answers every COMMAND of a client with an RTS_COMMAND, and never waits for one itself.

    The commands are carried out in order. Only a few of them are submitted at a time, so that no
    client can crowd the others out of a tick. While a registration is being checked, the commands
    after it wait.
    """

    def __init__(self, connection: ClientConnection, submit: Submit):
        """`submit` takes checked arguments and returns the answer's future immediately."""
        self._connection = connection
        self._submit = submit
        self._loop = asyncio.get_running_loop()
        self._running = 0
        self._is_checking = False
        self._waiting: deque[tuple[Command, Mapping[str, Any]]] = deque()
        self._waiting_bytes = 0

    def handle(self, command: Command) -> None:
        """Check a command and carry it out in its turn."""
        try:
            arguments = check_arguments(command.name, decode_json_object(command.body))
            is_full = len(self._waiting) >= WAITING_COMMANDS
            if is_full or self._waiting_bytes > WAITING_COMMAND_BYTES:
                raise InputError(TOO_MANY)
        except InputError as error:
            self._reply(command, Answer(0, False, str(error)))
            return
        self._waiting.append((command, arguments))
        self._waiting_bytes += len(command.body)
        self._submit_waiting()

    def _submit_waiting(self) -> None:
        while self._waiting and self._running < COMMANDS_AT_ONCE:
            is_checked = self._waiting[0][0].name in CHECKED
            if self._is_checking or (is_checked and self._running):
                return
            self._is_checking = is_checked
            command, arguments = self._waiting.popleft()
            self._waiting_bytes -= len(command.body)
            self._running += 1
            future = self._submit(self._connection, command.name, arguments)
            future.add_done_callback(partial(self._note_answer, command))

    def _note_answer(self, command: Command, done: Future[Answer]) -> None:
        # What still waits when the simulator ends is refused after its event loop is closed.
        with contextlib.suppress(RuntimeError):
            self._loop.call_soon_threadsafe(self._answered, command, done)

    def _answered(self, command: Command, done: Future[Answer]) -> None:
        if self._connection.closed.is_set():
            return
        self._running -= 1
        self._is_checking = False
        answer = Answer(0, False, "The simulator could not carry the command out.")
        if not done.cancelled() and done.exception() is None:
            answer = done.result()
        self._reply(command, answer)
        self._submit_waiting()

    def _reply(self, command: Command, answer: Answer) -> None:
        """Send an answer; its body repeats the sentence for clients that read no metadata.

        A refusal by the rules of a trial has a code and values besides the sentence.
        """
        metadata, data = {STATUS_KEY: SUCCESS if answer.ok else FAIL}, dict(answer.data)
        if not answer.ok:
            sentence = told(answer.message)
            metadata[ERROR_KEY] = data["error"] = sentence
            if isinstance(sentence, LocalizedText):
                data.update(code=sentence.key, values=dict(sentence.values))
        name = command.name if command.name.isascii() and command.name.isprintable() else ""
        body = json.dumps(data, allow_nan=False)
        reply = CommandReply(command.command_id, name, body)
        self._connection.send(Outgoing(Message(DeviceName.COMMAND, reply, metadata)))


class SimulatorLink:
    """Answers commands, echoes foreign transforms and publishes the simulation's state.

    A TRANSFORM with a foreign device name is echoed to its sender, unchanged: the test of the link
    and the measure of its delay. Anything else that is valid is accepted and ignored, such as the
    STATUS with which Slicer starts every connection.
    """

    def __init__(
        self,
        latest: Callable[[], SimulationState],
        submit: SubmitCommand,
        unacknowledged: Callable[[], Sequence[DeliveredRecord]],
        arrivals: Callable[[], int],
        find_scenario: Callable[[str], Scenario],
        health: Callable[[], Mapping[str, Any]] = dict,
        limits: LinkLimits | None = None,
        answers: Callable[[], Sequence[StepAnswers]] = tuple,
        slicer_left: Callable[[], None] = lambda: None,
    ):
        """Make a link, in the event loop's thread.

        `arrivals` counts the records that `unacknowledged` gives, since the start; `find_scenario`
        gives the present scenario for "", in any thread; `health` is for the heartbeat; `answers`
        gives a study's answers that Slicer has not taken yet; `slicer_left` is called when the last
        client that registers and scores has left.
        """
        self.server = IgtlServer(self, limits)
        self.publisher = Publisher(latest)
        self.offers = TrialOffers(unacknowledged, lambda: self.server.clients)
        self._arrivals = arrivals
        self._offered_arrivals = arrivals()
        registering = ThreadPoolExecutor(max_workers=1, thread_name_prefix="registration")
        check = partial(submit_checked, submit, lambda: latest().training, find_scenario)
        self._submit_checked: SubmitCommand = partial(registering.submit, check)
        self._submit_command = submit
        self._health = health
        self._answers = answers
        self._slicer_left = slicer_left
        self._commands: dict[ClientConnection, ClientCommands] = {}
        self._submitted: set[Future[Answer]] = set()

    def connected(self, connection: ClientConnection) -> None:
        self._commands[connection] = ClientCommands(connection, self._submit)
        connection.send_latest(self._heartbeat())
        self.publisher.subscribe(connection, PoseSubscription())

    def received(self, connection: ClientConnection, message: Message) -> None:
        content = message.content
        if type(content) is Command:
            self._commands[connection].handle(content)
        elif type(content) is Transform and message.device not in _OWN_DEVICES:
            # A name that cannot be sent back, as one without ASCII, gets no echo.
            with contextlib.suppress(InputError):
                connection.send_latest(Outgoing(message))

    def disconnected(self, connection: ClientConnection) -> None:
        self.publisher.unsubscribe(connection)
        del self._commands[connection]
        if connection.scores and not self.is_slicer_connected:
            self._slicer_left()

    def publish(self, state: SimulationState) -> None:
        """Publish the devices that are due, and offer a trial that has just been closed."""
        self.publisher.publish(state)
        arrivals = self._arrivals()
        if arrivals != self._offered_arrivals:
            self._offered_arrivals = arrivals
            self.offers.offer_newest()

    async def beat(self) -> None:
        """Send the heartbeat every second and repeat the offers; never returns."""
        seconds = 0
        while True:
            await asyncio.sleep(1.0 / Rate.HEARTBEAT_HZ)
            beat = self._heartbeat()
            for connection in self.server.clients:
                connection.send_latest(beat)
            for number, answers in enumerate(self._answers(), start=1):
                command = Command(
                    number, CommandName.STEP_ANSWERED, json.dumps(record_to_json(answers))
                )
                for connection in self.server.clients:
                    connection.send(Outgoing(Message(DeviceName.COMMAND, command)))
            seconds += 1
            if seconds % Rate.OFFER_PERIOD_S == 0:
                self.offers.repeat()

    @property
    def is_slicer_connected(self) -> bool:
        """Whether a client registers and scores: others, such as displays, may only listen."""
        return any(connection.scores for connection in self.server.clients)

    def _heartbeat(self) -> Outgoing:
        details = {"clients": len(self.server.clients), **self._health()}
        text = json.dumps({"protocolVersion": PROTOCOL_VERSION, **details}, allow_nan=False)
        status = Status(Status.OK, subcode=PROTOCOL_VERSION, message=text)
        return Outgoing(Message(DeviceName.SIM_SERVER, status))

    def _submit(
        self, connection: ClientConnection, name: str, arguments: Mapping[str, Any]
    ) -> Future[Answer]:
        if name == CommandName.HELLO:
            return answered(self._greet(connection, arguments))
        is_for_scorers = COMMANDS[name].is_for_scorers
        if is_for_scorers and not connection.scores:
            sentence = (
                f"{name} is for clients that register and score: send Hello, with scores, first."
            )
            return answered(Answer(0, False, sentence))
        is_offered = (
            name != CommandName.ACKNOWLEDGE_TRIAL or arguments["trialId"] in connection.offered
        )
        if not is_offered:
            sentence = "This trial was not offered over this connection."
            return answered(Answer(0, False, sentence))
        if len(self._submitted) >= COMMANDS_OF_ALL:
            return answered(Answer(0, False, TOO_MANY))
        submit = self._submit_checked if name in CHECKED else self._submit_command
        future = submit(name, arguments, connection.name)
        self._submitted.add(future)
        # In any thread: each of these changes of the set is a single step.
        future.add_done_callback(self._submitted.discard)
        return future

    def _greet(self, connection: ClientConnection, arguments: Mapping[str, Any]) -> Answer:
        spoken = {
            "protocolVersion": PROTOCOL_VERSION,
            "server": "RASTrainer simulator",
            "version": rastrainer.__version__,
        }
        version = arguments["protocolVersion"]
        if version != PROTOCOL_VERSION:
            sentence = (
                f"This simulator speaks protocol version {PROTOCOL_VERSION}, not {version}: "
                "install RASTrainer of the same version on both sides."
            )
            return Answer(0, False, sentence, spoken)
        connection.name, connection.scores = arguments["client"], arguments["scores"]
        requested = {name: arguments[name] for name in ("toolTipHz", "linksHz", "steady")}
        self.publisher.subscribe(connection, PoseSubscription(*requested.values()))
        return Answer(0, True, data={**spoken, **requested})


@dataclass
class TrialOffers:
    """Offers the trials that no client has acknowledged, oldest first, to the clients that score.

    Clients keep trials by their UUID, so an offer that arrives twice does no harm.
    """

    unacknowledged: Callable[[], Sequence[DeliveredRecord]]
    clients: Callable[[], Iterable[ClientConnection]]
    _numbers: Iterator[int] = field(default_factory=lambda: itertools.count(1))
    _start: int = 0

    def offer_newest(self) -> None:
        """Offer the aborted trials, then the last registered trial.

        In a study, a client counts a repeat only if it knows which trials were aborted before.
        """
        records = self.unacknowledged()
        aborted = [record for record in records[:-1] if isinstance(record, AbortedTrial)]
        self._offer((*aborted[-OFFERS_AT_ONCE:], *records[-1:]))

    def repeat(self) -> None:
        """Offer some again, others in the next round, so that none delays the rest."""
        records = tuple(self.unacknowledged())
        start = self._start if self._start < len(records) else 0
        self._offer((records[start:] + records[:start])[:OFFERS_AT_ONCE])
        self._start = start + OFFERS_AT_ONCE if len(records) > OFFERS_AT_ONCE else 0

    def _offer(self, records: Iterable[DeliveredRecord]) -> None:
        for record in records:
            task = {"task": record.task} if isinstance(record, DrillRecord) else {}
            body = json.dumps(task | record_to_json(record), allow_nan=False)
            number = next(self._numbers) % _NUMBERS
            is_aborted = isinstance(record, AbortedTrial)
            name = CommandName.TRIAL_ABORTED if is_aborted else CommandName.TRIAL_COMPLETED
            command = Command(number, name, body)
            offer = Outgoing(Message(DeviceName.COMMAND, command))
            for connection in self.clients():
                if connection.scores:
                    connection.offered.add(record.trial_id)
                    connection.send(offer)
