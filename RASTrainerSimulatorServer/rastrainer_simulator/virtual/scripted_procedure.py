"""A procedure carried out by commands over OpenIGTLink, after the touches of a scripted trial."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import Any

from rastrainer.igtl.client import Client
from rastrainer.igtl.content import String
from rastrainer.procedure.checks import planned_bone
from rastrainer.procedure.meshes import read_procedure_meshes
from rastrainer.procedure.plan import ProcedureTrajectory
from rastrainer.protocol import CommandName, DeviceName, Phase
from rastrainer.scenario.scenario import Scenario
from rastrainer.trial.given_points import GivenPoints
from rastrainer.trial.record import TrialRecord
from rastrainer.trial.touch_registration import register_trial
from rastrainer_simulator.virtual.scripted_trial import TrialStoppedError, send

STAND_OFF_MM = 30.0
ALIGNED_MM, ALIGNED_DEG = 0.05, 0.05
PAST_INNER_MM = 1.0
"""The drill goes so far past the inner table that is planned: the bone is not where it is shown."""
DRILL_MM_S, INSERT_MM_S, LONGEST_FEED_S = 5.0, 10.0, 2.0
SLOW_FROM_MM, SLOW_MM_S = 2.0, 1.0
NEAR_MM = 0.1
STATE_TIMEOUT_S = 60.0
MAX_FEEDS = 200


def play_procedure(
    client: Client,
    scenario: Scenario,
    trial_id: str,
    on_progress: Callable[[str], None] = lambda _done: None,
) -> TrialRecord:
    """Carry the procedure of a registered trial out, and return the trial's record.

    The touches are registered as Slicer's side does; the robot aligns the guide by itself. Depths
    are fed by the plan as the registration shows it. `on_progress` gets what was done, in words.

    Raises:
        TrialStoppedError: the server refused a command, or a tool did not get where it should.
        LinkError: the connection was lost.
    """
    told = send(client, CommandName.GET_TRIAL, {"trialId": trial_id})
    registered = register_trial(GivenPoints.of_answer(told), scenario)
    send(client, CommandName.USE_REGISTRATION, registered.arguments(trial_id))
    send(client, CommandName.ACCEPT_REGISTRATION, {})
    state = _wait(client, lambda state: state["phase"] == Phase.ALIGNING.value)
    procedure = scenario.procedure(state["procedure"]["name"])
    assert scenario.skull_mesh is not None, "a scenario with procedures has a skull"
    skull = read_procedure_meshes(procedure, scenario.skull_mesh).skull
    for number, trajectory in enumerate(procedure.trajectories):
        bone = planned_bone(trajectory, skull)
        assert bone is not None, "the plan was checked"
        assert bone.inner_mm is not None, "the plan was checked"
        _place(client, trajectory, number, bone.inner_mm)
        on_progress(f"{trajectory.name}: the electrode is placed")
    told = send(client, CommandName.GET_TRIAL, {"trialId": trial_id})
    return TrialRecord.from_json(told["record"])


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
    """Feed what is in the guide to a depth, the last bit slowly."""
    depth = _depth(client, tool, -1.0)
    for _ in range(MAX_FEEDS):
        left = to_mm - depth
        if left <= NEAR_MM:
            return
        velocity = fastest_mm_s if left > 2.0 * SLOW_FROM_MM else SLOW_MM_S
        way = left - SLOW_FROM_MM if left > 2.0 * SLOW_FROM_MM else left
        duration = min(way / velocity, LONGEST_FEED_S)
        send(client, CommandName.FEED, {"velocityMmS": velocity, "durationS": duration})
        depth = _depth(client, tool, depth + 0.95 * velocity * duration)
    raise TrialStoppedError(f"The {tool} stopped at {depth:.1f} mm, before {to_mm:.1f} mm.")


def _depth(client: Client, tool: str, after: float) -> float:
    """Return how deep a tool is, once it is deeper than `after` (mm)."""

    def is_deeper(state: Mapping[str, Any]) -> bool:
        return state["procedure"]["tool"] == tool and state["procedure"]["feedMm"] > after

    return float(_wait(client, is_deeper)["procedure"]["feedMm"])


def _wait(client: Client, is_wanted: Callable[[Mapping[str, Any]], bool]) -> Mapping[str, Any]:
    """Return the first state that is wanted."""

    def is_it(message: Any) -> bool:
        assert isinstance(message.content, String)
        return is_wanted(json.loads(message.content.text))

    found = client.wait_for(DeviceName.SIM_STATE, is_it, STATE_TIMEOUT_S)
    assert isinstance(found.content, String)
    return json.loads(found.content.text)
