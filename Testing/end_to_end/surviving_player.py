"""A trainee over OpenIGTLink who notes acknowledged commands and returns after every crash."""

from __future__ import annotations

import json
import random
import time
from collections.abc import Callable

import numpy as np

from rastrainer import transforms
from rastrainer.commands import CommandName
from rastrainer.igtl.client import Client, LinkError, Reply
from rastrainer.igtl.content import Command
from rastrainer.igtl.message import Message
from rastrainer.protocol import PROTOCOL_VERSION, DeviceName
from rastrainer.scenario.scenario import Scenario
from Testing.end_to_end.onto_skin import carry_to, lower_onto_skin

TASK = "task-1"
TRAINEE = "T-042"
ABOVE_MM = 30.0
TIMEOUT_S = 120.0

NOT_REPORTED: tuple[float, ...] = ()
"""The position of a touch that counts though the kill has swallowed its answer."""

Touch = tuple[str, tuple[float, ...]]


class Killing:
    """When to kill a process: at the server's n-th message, or while it carries out a command."""

    def __init__(self, rng: random.Random, kill: Callable[[], None], at_commands: bool = True):
        """Kill by `kill`; `at_commands` is for the server's own death alone."""
        self._kill = kill
        self._messages = rng.randrange(1, 500)
        # One in three dies with a command in transit: at the disk, or before or after.
        self._command = rng.choice([None, None, rng.randrange(1, 12)]) if at_commands else None
        self._delay_s = rng.uniform(0.0, 0.006)
        self.is_done = False

    def heard(self, _message: Message) -> None:
        """Count a message of the server; called in the client's thread."""
        self._messages -= 1
        if self._messages == 0:
            self.now()

    def is_due(self) -> bool:
        """Return whether to kill during the command that is about to be sent."""
        if self._command is None:
            return False
        self._command -= 1
        return self._command == 0

    def while_it_works(self) -> None:
        """Kill a moment after a command has been sent."""
        time.sleep(self._delay_s)
        self.now()

    def now(self) -> None:
        """Die."""
        if not self.is_done:
            self.is_done = True
            self._kill()


class SurvivingPlayer:
    """Plays trial after trial.

    Attributes:
        trainee, task: of the trials that are begun.
        kept: for each trial the touches that were acknowledged and not undone.
        registered: the trials whose registration was acknowledged.
        resumed: how often an interrupted trial was resumed.
        trial_id: of the present trial; "" between two.
    """

    def __init__(self, scenario: Scenario, rng: random.Random, trainee: str = TRAINEE):
        self._scenario = scenario
        self._rng = rng
        self.trainee = trainee
        self.task = TASK
        self._seed = 0
        self._in_flight = ""
        self.kept: dict[str, list[Touch]] = {}
        self.registered: set[str] = set()
        self.resumed = 0
        self.trial_id = ""

    def play(self, port: int, killing: Killing | None, trials: int) -> bool:
        """Play until a number of trials are registered; return whether the server survived."""
        done = len(self.registered) + trials
        heard = None if killing is None else killing.heard
        try:
            with Client(port=port, on_message=heard) as client:
                self._send_hello(client)
                self._come_back(client)
                while len(self.registered) < done:
                    self._play_on(client, killing)
        except LinkError:
            assert killing is not None
            assert killing.is_done
            return False
        return True

    def _send_hello(self, client: Client) -> None:
        hello = {"protocolVersion": PROTOCOL_VERSION, "client": "player", "linksHz": 0}
        assert client.send_command(CommandName.HELLO, hello, TIMEOUT_S).ok

    def _come_back(self, client: Client) -> None:
        """Check that the server has all that it acknowledged, and asks for the right point."""
        state = self._state(client)
        points = client.wait_for(DeviceName.CAPTURED_POINTS, timeout=TIMEOUT_S).content.points
        in_flight, self._in_flight = self._in_flight, ""
        if not self.trial_id and state["trialId"] in self.registered:
            return
        if state["phase"] == "idle":
            # Only a trial that was never acknowledged or that is over may be missing.
            assert not self.trial_id or in_flight == CommandName.REGISTER
            self.trial_id = ""
            return
        if not self.trial_id:
            assert in_flight == CommandName.START_TASK
            self._begin(state["trialId"])
        assert state["trialId"] == self.trial_id
        kept = self.kept[self.trial_id]
        allowed = {len(kept)}
        allowed |= {len(kept) + 1} if in_flight == CommandName.CAPTURE else set()
        allowed |= {len(kept) - 1} if in_flight == CommandName.UNDO else set()
        assert len(points) in allowed, (in_flight, len(points), len(kept))
        for (label, position), point in zip(kept, points, strict=False):
            assert point.label == label
            if position != NOT_REPORTED:
                np.testing.assert_allclose(point.position, position, atol=1e-3)
        del kept[len(points) :]
        for point in points[len(kept) :]:
            kept.append((point.label, NOT_REPORTED))
        following = None if len(points) == 15 else str(len(points) + 1)
        assert state["nextPoint"] == following
        if state["phase"] == "paused":
            self._send(client, CommandName.RESUME, None)
        self.resumed += 1

    def _play_on(self, client: Client, killing: Killing | None) -> None:
        """Do the next step of a trial."""
        if not self.trial_id:
            self._seed = self._rng.randrange(2**31)
            start = {"task": self.task, "trainee": self.trainee, "seed": self._seed}
            self._begin(self._send(client, CommandName.START_TASK, killing, **start)["trialId"])
            return
        kept = self.kept[self.trial_id]
        if kept and self._rng.random() < 0.08:
            self._send(client, CommandName.UNDO, killing)
            kept.pop()
        elif len(kept) == 15:
            self._send(client, CommandName.REGISTER, killing)
            self.registered.add(self.trial_id)
            self.trial_id = ""
        else:
            self._go_to(client, len(kept))
            answer = self._send(client, CommandName.CAPTURE, killing)
            kept.append((answer["label"], tuple(answer["positionMm"])))

    def _begin(self, trial_id: str) -> None:
        self.trial_id = trial_id
        self.kept[trial_id] = []

    def _go_to(self, client: Client, number: int) -> None:
        """Lift off from wherever the tip is, and come down on the point `number`."""
        head_to_world = self._scenario.perturbed_head_to_world(self._seed)
        points = [*self._scenario.task(self.task).fiducials, self._scenario.target.position_ras]
        *places, center = transforms.apply(head_to_world, np.array(points))
        place = places[number]
        tip = client.wait_for(DeviceName.TOOL_TIP_TO_WORLD, timeout=TIMEOUT_S)
        lifted = _above(np.array(tip.content.matrix)[:3, 3], center)
        self._in_flight = CommandName.MOVE_TIP_TO
        for goal in (lifted, _above(place, center)):
            carry_to(client, goal, 3.0)
        lower_onto_skin(client, place, center)
        self._in_flight = ""

    def _send(self, client: Client, name: str, killing: Killing | None, **arguments) -> dict:
        """Carry out a command; a command in transit when the server dies may count or not."""
        self._in_flight = name
        if killing is not None and killing.is_due():
            body = json.dumps(arguments)
            client.send(Message(DeviceName.COMMAND, Command(2**31, name, body)))
            killing.while_it_works()
            raise LinkError("The server was killed.")
        reply: Reply = client.send_command(name, arguments, TIMEOUT_S)
        assert reply.ok, f"{name}: {reply.error}"
        self._in_flight = ""
        return dict(reply.data)

    def _state(self, client: Client) -> dict:
        message = client.wait_for(DeviceName.SIM_STATE, timeout=TIMEOUT_S)
        return json.loads(message.content.text)


def _above(place: np.ndarray, center: np.ndarray) -> np.ndarray:
    return place + ABOVE_MM * (place - center) / np.linalg.norm(place - center)
