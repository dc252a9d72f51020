"""One trial played by a scripted trainee over OpenIGTLink, as any client could play it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from rastrainer.errors import RASTrainerError
from rastrainer.igtl.client import Client
from rastrainer.igtl.content import String, Transform
from rastrainer.igtl.message import Message
from rastrainer.protocol import PROTOCOL_VERSION, CommandName, DeviceName, Mode, Phase, Proximity
from rastrainer.scenario.scenario import Scenario
from rastrainer_simulator.virtual.scripted_trainee import Observation, ScriptedTrainee, Skill

ANSWER_TIMEOUT_S = 10.0
LONGEST_TRIAL_S = 1800.0


class TrialStoppedError(RASTrainerError):
    """The trial could not be played to its end."""


@dataclass(frozen=True)
class ScriptedTrialResult:
    """A registered trial: its UUID, and the last state of the simulator that was seen in it."""

    trial_id: str
    last_state: dict[str, Any]


def say_hello(client: Client, name: str) -> None:
    """Greet the server, and subscribe to poses even while the arm is still: they are our clock.

    Raises:
        TrialStoppedError: it speaks another version of the protocol.
    """
    hello = {"protocolVersion": PROTOCOL_VERSION, "client": name, "steady": True}
    send(client, CommandName.HELLO, hello)


def play_trial(
    client: Client,
    scenario: Scenario,
    task_name: str,
    trainee_id: str,
    seed: int,
    skill: Skill | None = None,
    on_progress: Callable[[dict[str, Any]], None] = lambda _state: None,
    procedure: str = "",
) -> ScriptedTrialResult:
    """Play one task from its start to its registration, by commands alone.

    `StartTask` gets the same seed, by which the scripted trainee knows where the head is, as a
    person sees on the screen. `on_progress` gets every new `SimState`. `procedure` is to follow the
    registration; it is carried out by others.

    Raises:
        TrialStoppedError: the server refused a command, or the tip did not reach a fiducial.
        LinkError: the connection was lost.
    """
    head_to_world = scenario.perturbed_head_to_world(seed)
    trainee = ScriptedTrainee.of(scenario, task_name, head_to_world, skill or Skill(), seed)
    start = {"task": task_name, "trainee": trainee_id, "mode": Mode.DESKTOP.value, "seed": seed}
    if procedure:
        start["procedure"] = procedure
    trial_id = send(client, CommandName.START_TASK, start)["trialId"]
    view = _View(client, trial_id, on_progress)
    observation = view.next_observation()
    ends_at_s = observation.sim_time_s + LONGEST_TRIAL_S
    while observation.sim_time_s < ends_at_s:
        observation = view.next_observation()
        action = trainee.decide(observation)
        if action is None:
            continue
        name, arguments = action
        reply = client.send_command(name, arguments, ANSWER_TIMEOUT_S)
        if name == CommandName.CAPTURE and not reply.ok:
            trainee.touch_refused()
        elif not reply.ok:
            raise TrialStoppedError(f"{name} was refused: {reply.error}")
        if name == CommandName.REGISTER:
            return ScriptedTrialResult(trial_id, view.state)
    raise TrialStoppedError(
        f"{task_name} was not finished in {LONGEST_TRIAL_S:g} s of simulated time: the tip did not "
        f"get to point {observation.next_point}."
    )


class _View:
    """What the scripted trainee sees of the running trial."""

    def __init__(self, client: Client, trial_id: str, on_progress: Callable) -> None:
        self._client = client
        self._trial_id = trial_id
        self._on_progress = on_progress
        self._sequence = -1
        self.state: dict[str, Any] = {}

    def next_observation(self) -> Observation:
        """Wait for the next pose of the tip and return it with the latest state."""
        tip = self._client.wait_for(DeviceName.TOOL_TIP_TO_WORLD, self._is_next, ANSWER_TIMEOUT_S)
        self._sequence = int(tip.metadata["seq"])
        state = _state(self._client.wait_for(DeviceName.SIM_STATE, self._is_ours))
        assert isinstance(tip.content, Transform)
        if state != self.state:
            self.state = state
            self._on_progress(state)
        point = state["nextPoint"]
        return Observation(
            sim_time_s=float(tip.metadata["simTime"]),
            tip_mm=np.array(tip.content.matrix)[:3, 3],
            is_in_contact=state["proximity"] == Proximity.CONTACT.value,
            phase=Phase(state["phase"]),
            next_point=None if point is None else int(point),
        )

    def _is_next(self, message: Message) -> bool:
        return int(message.metadata["seq"]) > self._sequence

    def _is_ours(self, message: Message) -> bool:
        return _state(message)["trialId"] == self._trial_id


def _state(message: Message) -> dict[str, Any]:
    assert isinstance(message.content, String)
    return json.loads(message.content.text)


def send(client: Client, name: str, arguments: dict[str, Any]) -> dict[str, Any]:
    """Have a command carried out, and return the data of its answer.

    Raises:
        TrialStoppedError: it was refused.
    """
    reply = client.send_command(name, arguments, ANSWER_TIMEOUT_S)
    if not reply.ok:
        raise TrialStoppedError(f"{name} was refused: {reply.error}")
    return dict(reply.data)
