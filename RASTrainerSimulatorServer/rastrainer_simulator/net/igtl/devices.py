"""The simulation's state as messages: metres become millimetres here and nowhere else."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from rastrainer.igtl.content import Status, String, Transform
from rastrainer.igtl.message import Message
from rastrainer.igtl.points import Point, Points
from rastrainer.protocol import PROTOCOL_VERSION, DeviceName
from rastrainer.units import MM_PER_M
from rastrainer_simulator.state import SimulationState, TrainingState


def tool_tip(state: SimulationState, seq: int) -> Message:
    """Return the tool tip's pose, with what Slicer cannot read from a header in its metadata."""
    metadata = {
        "seq": str(seq),
        "simTime": f"{state.sim_time:.6f}",
        "TransformStatus": "OK",
    }
    return Message(DeviceName.TOOL_TIP_TO_WORLD, _transform(state.tool_tip_to_world), metadata)


def links(state: SimulationState, seq: int) -> tuple[Message, ...]:
    """Return the poses of the robot's links 0 to 7."""
    metadata = {"seq": str(seq)}
    return tuple(
        Message(device, _transform(pose), metadata)
        for device, pose in zip(DeviceName.LINK_TO_WORLD, state.link_to_world, strict=True)
    )


def captured_points(training: TrainingState) -> Message:
    """Return the whole list of touched points; its metadata let Slicer clear an empty one."""
    points = tuple(
        Point(touch.label, (MM_PER_M * x, MM_PER_M * y, MM_PER_M * z))
        for touch in training.touches
        for x, y, z in [touch.position]
    )
    metadata = {"count": str(len(points)), "trialId": training.trial_id}
    return Message(DeviceName.CAPTURED_POINTS, Points(points), metadata)


def what_changes(state: SimulationState) -> dict[str, Any]:
    """Return what `SimState` says beside its number and time; sent again when it changes."""
    training = state.training
    return {
        "phase": training.phase.value,
        "trainee": training.trainee,
        "task": training.task,
        "mode": training.mode,
        "trialId": training.trial_id,
        "nextPoint": training.next_point,
        "instruction": training.instruction,
        "proximity": state.proximity.value,
        "clearanceMm": _rounded(MM_PER_M * state.clearance, 3),
        "depthMm": _rounded(MM_PER_M * state.depth, 3),
        "q": [_rounded(angle, 6) for angle in state.q],
        "operator": state.operator,
    }


def sim_state(changing: Mapping[str, Any], state: SimulationState, seq: int) -> Message:
    """Return the text that says where the trial and the robot stand: ASCII JSON.

    `changing` is what `what_changes` gives; the times go along and are no reason to send it.
    """
    times = {"simTime": round(state.sim_time, 6), "elapsedS": round(state.elapsed, 3)}
    text = json.dumps({"seq": seq, **times, **changing}, allow_nan=False)
    return Message(DeviceName.SIM_STATE, String(text))


def heartbeat(details: Mapping[str, Any]) -> Message:
    """Return the server's sign of life; its subcode is the protocol's version."""
    text = json.dumps({"protocolVersion": PROTOCOL_VERSION, **details}, allow_nan=False)
    status = Status(Status.OK, subcode=PROTOCOL_VERSION, message=text)
    return Message(DeviceName.SIM_SERVER, status)


def _transform(pose: np.ndarray) -> Transform:
    """Return a (4, 4) float pose (m) as a transform (mm)."""
    *axes, x, y, z = pose[:3].T.ravel().tolist()
    return Transform((*axes, MM_PER_M * x, MM_PER_M * y, MM_PER_M * z))


def _rounded(value: float, digits: int) -> float | None:
    return round(value, digits) if math.isfinite(value) else None
