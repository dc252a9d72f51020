"""The simulator on the link: what each message of a client leads to, and the server's heartbeat."""

from __future__ import annotations

import asyncio
import contextlib
import json
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Future
from typing import Any

import rastrainer
from rastrainer.aborted_trial import AbortedTrial
from rastrainer.errors import InputError
from rastrainer.experiment.step_answers import StepAnswers
from rastrainer.igtl.command import Command
from rastrainer.igtl.content import Transform
from rastrainer.igtl.message import Message
from rastrainer.protocol import PROTOCOL_VERSION, CommandName, Device, Phase, Rate
from rastrainer.trial_record import TrialRecord
from rastrainer_simulator.igtl import devices
from rastrainer_simulator.igtl.command_handler import CommandHandler
from rastrainer_simulator.igtl.connection import Connection
from rastrainer_simulator.igtl.limits import Limits
from rastrainer_simulator.igtl.outgoing import Outgoing
from rastrainer_simulator.igtl.pose_subscription import PoseSubscription
from rastrainer_simulator.igtl.publisher import Publisher
from rastrainer_simulator.igtl.server import IgtlServer
from rastrainer_simulator.igtl.trial_offers import TrialOffers
from rastrainer_simulator.state import Answer, SimulationState

_OWN_DEVICES = frozenset({Device.TOOL_TIP_TO_WORLD, *Device.LINK_TO_WORLD})

SubmitCommand = Callable[[str, Mapping[str, Any], str], "Future[Answer]"]


class SimulatorLink:
    """Answers commands, echoes foreign transforms and publishes the simulation's state.

    A TRANSFORM whose device is none of ours is sent back to its sender, unchanged: the test of
    the link and the measure of its delay. All else that is valid is taken and ignored, such as
    the STATUS with which Slicer begins every connection.

    Attributes:
        server: listens or connects, and owns the clients.
        publisher: tells them the state.
        offers: the trials that wait to be acknowledged.
    """

    def __init__(
        self,
        latest: Callable[[], SimulationState],
        submit: SubmitCommand,
        unacknowledged: Callable[[], Sequence[AbortedTrial | TrialRecord]],
        health: Callable[[], Mapping[str, Any]] = dict,
        limits: Limits | None = None,
        answers: Callable[[], Sequence[StepAnswers]] = tuple,
    ):
        """Make a link, in the event loop's thread.

        Args:
            latest: gives the newest state.
            submit: takes a command's name, checked arguments and sender, and returns the
                answer's future at once.
            unacknowledged: gives the records of the trials that no client has acknowledged.
            health: gives what the heartbeat tells of the simulator, ready for JSON.
            limits: what clients may cost.
            answers: gives a study's answers that Slicer has not taken yet.
        """
        self.server = IgtlServer(self, limits)
        self.publisher = Publisher(latest)
        self.offers = TrialOffers(unacknowledged, lambda: self.server.clients)
        self._told = Phase.IDLE
        self._submit_command = submit
        self._health = health
        self._answers = answers
        self._commands = CommandHandler(self._submit, self.server.limits)

    def connected(self, connection: Connection) -> None:
        """Tell a client how things stand."""
        connection.send_latest(self._heartbeat())
        self.publisher.subscribe(connection, PoseSubscription())

    def received(self, connection: Connection, message: Message) -> None:
        """Do what a message asks for."""
        content = message.content
        if type(content) is Command:
            self._commands.handle(connection, content)
        elif type(content) is Transform and message.device not in _OWN_DEVICES:
            # A name that cannot be sent back, as one without ASCII, gets no echo.
            with contextlib.suppress(InputError):
                connection.send_latest(Outgoing(message))

    def disconnected(self, connection: Connection) -> None:
        """Forget a client."""
        self.publisher.unsubscribe(connection)
        self._commands.forget(connection)

    def tell(self, state: SimulationState) -> None:
        """Publish what is due, and offer a trial as soon as it is registered."""
        self.publisher.publish(state)
        phase = state.training.phase
        if phase is Phase.REGISTERED and self._told is not phase:
            self.offers.offer_newest()
        self._told = phase

    async def beat(self) -> None:
        """Send the heartbeat every second and repeat the offers; never returns."""
        seconds = 0
        while True:
            await asyncio.sleep(1.0 / Rate.HEARTBEAT_HZ)
            beat = self._heartbeat()
            for connection in self.server.clients:
                connection.send_latest(beat)
            self._tell_answers()
            seconds += 1
            if seconds % Rate.OFFER_PERIOD_S == 0:
                self.offers.repeat()

    def _tell_answers(self) -> None:
        for number, answers in enumerate(self._answers(), start=1):
            command = Command(number, CommandName.STEP_ANSWERED, json.dumps(answers.to_json()))
            for connection in self.server.clients:
                connection.send(Outgoing(Message(Device.COMMAND, command)))

    def _heartbeat(self) -> Outgoing:
        clients = len(self.server.clients)
        return Outgoing(devices.heartbeat({"clients": clients, **self._health()}))

    def _submit(
        self, connection: Connection, name: str, arguments: Mapping[str, Any]
    ) -> Future[Answer]:
        if name != CommandName.HELLO:
            return self._submit_command(name, arguments, connection.name)
        greeted: Future[Answer] = Future()
        greeted.set_result(self._greet(connection, arguments))
        return greeted

    def _greet(self, connection: Connection, arguments: Mapping[str, Any]) -> Answer:
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
        connection.name = arguments["client"]
        wishes = {wish: arguments[wish] for wish in ("toolTipHz", "linksHz", "steady")}
        self.publisher.subscribe(connection, PoseSubscription(*wishes.values()))
        return Answer(0, True, data={**spoken, **wishes})
