"""A trial, and its procedure, by a scripted trainee over OpenIGTLink, as any client could."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

import numpy as np

from rastrainer.commands import CommandName
from rastrainer.igtl.client import Client
from rastrainer.igtl.content import String, Transform
from rastrainer.igtl.message import Message
from rastrainer.json_records import record_from_json
from rastrainer.procedure.checks import planned_bone
from rastrainer.procedure.plan import ProcedureTrajectory, read_procedure_meshes
from rastrainer.protocol import PROTOCOL_VERSION, DeviceName, Mode, Phase, Proximity
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.touch_registration import GivenPoints, register_trial
from rastrainer_simulator.virtual.hand import Skill
from rastrainer_simulator.virtual.scripted_trainee import (
    LONGEST_TRIAL_S,
    Observation,
    ScriptedTrainee,
    TrialStoppedError,
)

ANSWER_TIMEOUT_S = 60.0


class ScriptedTrial(NamedTuple):
    """A registered trial: its UUID, and the last state of the simulator that was seen in it."""

    trial_id: str
    last_state: dict[str, Any]


def send_hello(client: Client, name: str) -> None:
    """Greet the server, and subscribe to poses even while the arm is still: they are our clock."""
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
) -> ScriptedTrial:
    """Play one task from its start to its registration, by commands alone.

    `StartTask` gets the same seed, by which the scripted trainee knows where the head is, as a
    person sees on the screen. `on_progress` gets every new `SimState`. `procedure` is to follow the
    registration; it is carried out by others.
    """
    head_to_world = scenario.perturbed_head_to_world(seed)
    trainee = ScriptedTrainee(scenario, task_name, head_to_world, skill or Skill(), seed)
    start = {"task": task_name, "trainee": trainee_id, "mode": Mode.DESKTOP.value, "seed": seed}
    if procedure:
        start["procedure"] = procedure
    trial_id = send(client, CommandName.START_TASK, start)["trialId"]
    state: dict[str, Any] = {}
    sequence, ends_at_s = -1, np.inf
    while True:

        def is_new(message: Message, seen: int = sequence) -> bool:
            return int(message.metadata["seq"]) > seen

        tip = client.wait_for(DeviceName.TOOL_TIP_TO_WORLD, is_new, ANSWER_TIMEOUT_S)
        assert isinstance(tip.content, Transform)
        sequence, now_s = int(tip.metadata["seq"]), float(tip.metadata["simTimeS"])
        ends_at_s = min(ends_at_s, now_s + LONGEST_TRIAL_S)
        latest = _wait(client, lambda state: state["trialId"] == trial_id)
        if latest != state:
            state = dict(latest)
            on_progress(state)
        observation = Observation(
            sim_time_s=now_s,
            tip_mm=np.array(tip.content.matrix)[:3, 3],
            is_in_contact=state["proximity"] == Proximity.CONTACT.value,
            phase=Phase(state["phase"]),
            next_point=int(state["nextPoint"] or 0),
        )
        if now_s >= ends_at_s:
            break
        action = trainee.decide(observation)
        if action is None:
            continue
        name, arguments = action
        if name == CommandName.CAPTURE:
            if not client.send_command(name, arguments, ANSWER_TIMEOUT_S).ok:
                trainee.touch_refused()
        else:
            send(client, name, arguments)
        if name == CommandName.REGISTER:
            return ScriptedTrial(trial_id, state)
    raise TrialStoppedError(
        f"{task_name} was not finished in {LONGEST_TRIAL_S:g} s of simulated time: the tip did not "
        f"get to point {observation.next_point}."
    )


def _state(message: Message) -> dict[str, Any]:
    assert isinstance(message.content, String)
    return json.loads(message.content.text)


def send(client: Client, name: str, arguments: dict[str, Any]) -> dict[str, Any]:
    """Have a command carried out, and return the data of its answer."""
    reply = client.send_command(name, arguments, ANSWER_TIMEOUT_S)
    if not reply.ok:
        raise TrialStoppedError(f"{name} was refused: {reply.error}")
    return dict(reply.data)


STAND_OFF_MM = 30.0
ALIGNED_MM, ALIGNED_DEG = 0.05, 0.05
PAST_INNER_MM = 1.0
"""The drill goes this far past the planned inner table: the bone is not where it is shown."""
DRILL_MM_S, INSERT_MM_S, LONGEST_FEED_S = 5.0, 10.0, 2.0
SLOW_FROM_MM, SLOW_MM_S = 2.0, 1.0
NEAR_MM = 0.1
MAX_FEEDS = 200


def play_procedure(
    client: Client,
    scenario: Scenario,
    trial_id: str,
    on_progress: Callable[[str], None] = lambda _done: None,
) -> TrialRecord:
    """Carry out the procedure of a registered trial, and return the trial's record.

    The touches are registered as Slicer's side does; the robot aligns the guide by itself. Depths
    are fed by the plan as the registration shows it. `on_progress` gets each finished step, in
    words.
    """
    answer = send(client, CommandName.GET_TRIAL, {"trialId": trial_id})
    registered = register_trial(GivenPoints.of_answer(answer), scenario)
    send(client, CommandName.USE_REGISTRATION, registered.arguments(trial_id))
    send(client, CommandName.ACCEPT_REGISTRATION, {})
    state = _wait(client, lambda state: state["phase"] == Phase.ALIGNING.value)
    procedure = scenario.procedure(state["procedure"]["name"])
    skull = read_procedure_meshes(procedure, scenario.skull_path).skull
    for number, trajectory in enumerate(procedure.trajectories):
        bone = planned_bone(trajectory, skull)
        assert bone is not None, "the plan was checked"
        assert bone.inner_mm is not None, "the plan was checked"
        _place(client, trajectory, number, bone.inner_mm)
        on_progress(f"{trajectory.name}: the electrode is placed")
    answer = send(client, CommandName.GET_TRIAL, {"trialId": trial_id})
    return record_from_json(TrialRecord, answer["record"])


def _place(client: Client, trajectory: ProcedureTrajectory, number: int, inner_mm: float) -> None:
    """Align the guide, drill and place the instrument on one line."""

    def is_aligned(state: Mapping[str, Any]) -> bool:
        here = state["procedure"]
        if here["tool"] != "guide" or here["trajectory"] != number:
            return False
        off = abs(here["standOffMm"] - STAND_OFF_MM)
        return max(here["entryDistanceMm"], off) < ALIGNED_MM and here["angleDeg"] < ALIGNED_DEG

    send(client, CommandName.ALIGN_GUIDE, {"standOffMm": STAND_OFF_MM})
    _wait(client, is_aligned)
    send(client, CommandName.LOCK_GUIDE, {})
    _feed(client, "drill", STAND_OFF_MM + inner_mm + PAST_INNER_MM, DRILL_MM_S)
    send(client, CommandName.START_INSERTION, {})
    _feed(client, "electrode", STAND_OFF_MM + trajectory.length_mm, INSERT_MM_S)
    send(client, CommandName.RELEASE_INSTRUMENT, {})


def _feed(client: Client, tool: str, to_mm: float, fastest_mm_s: float) -> None:
    """Feed the tool in the guide to a depth, the last bit slowly."""

    def depth_beyond(after_mm: float) -> float:
        """Wait until the tool is deeper than that, and return its depth."""
        state = _wait(
            client,
            lambda state: (
                state["procedure"]["tool"] == tool and state["procedure"]["feedMm"] > after_mm
            ),
        )
        return float(state["procedure"]["feedMm"])

    depth = depth_beyond(-1.0)
    for _ in range(MAX_FEEDS):
        left = to_mm - depth
        if left <= NEAR_MM:
            return
        velocity = fastest_mm_s if left > 2.0 * SLOW_FROM_MM else SLOW_MM_S
        way = left - SLOW_FROM_MM if left > 2.0 * SLOW_FROM_MM else left
        duration = min(way / velocity, LONGEST_FEED_S)
        send(client, CommandName.FEED, {"velocityMmS": velocity, "durationS": duration})
        depth = depth_beyond(depth + 0.95 * velocity * duration)
    raise TrialStoppedError(f"The {tool} stopped at {depth:.1f} mm, before {to_mm:.1f} mm.")


def _wait(client: Client, is_wanted: Callable[[Mapping[str, Any]], bool]) -> Mapping[str, Any]:
    """Return the first state that is wanted."""
    found = client.wait_for(
        DeviceName.SIM_STATE, lambda message: is_wanted(_state(message)), ANSWER_TIMEOUT_S
    )
    return _state(found)
